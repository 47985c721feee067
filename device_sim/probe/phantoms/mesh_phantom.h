#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "device_sim/probe/phantom.h"

namespace sonoloft::device_sim {

/// The inside of a closed triangle mesh as one label. A vertex that lies exactly on a plane counts as above it, as if
/// the plane were lower by less than any number: every section is closed, whatever the plane goes through.
/// Frame: reference, mm.
class MeshPhantom final : public Phantom {
 public:
  /// @param triangles [#T] indices into positions_mm, wound the same way round
  /// @error a label that is no material, an index out of range, a position that is no number, an edge without exactly
  /// two triangles that run it in
  ///        opposite directions, no volume, more than 2^28 triangles
  [[nodiscard]] static Made<MeshPhantom> make(std::vector<Eigen::Vector3d> positions_mm,
                                              std::vector<std::array<std::uint32_t, 3>> triangles, Label label);

  [[nodiscard]] Eigen::AlignedBox3d bounds() const override { return bounds_; }
  /// Even-odd of the section with the plane z = point_mm.z. @cost O(#T): for tests and tools
  [[nodiscard]] Label label_at(const Eigen::Vector3d& point_mm) const override;
  /// @cost O(#V + #T)
  [[nodiscard]] PhantomSection section(const Eigen::Isometry3d& plane_to_reference) const override;
  /// @cost O(#T)
  [[nodiscard]] double volume_mm3() const;

 private:
  MeshPhantom() = default;

  std::vector<Eigen::Vector3d> positions_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;  ///< counter-clockwise seen from outside
  std::vector<std::uint32_t> twins_;  ///< [3 #T] half-edge 3 t + i runs corner i -> i + 1; its twin the other way
  Eigen::AlignedBox3d bounds_;
  Label label_ = kOutside;
};

}  // namespace sonoloft::device_sim
