#pragma once
// mesh -> [MESH TREE] -> its nearest triangle, and what it says of a point
#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>

#include "core/mesh/mesh.h"
#include "core/slice/label.h"

namespace sonoloft {

[[nodiscard]] inline std::array<Eigen::Vector3d, 3> corners(const IndexedMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {mesh.positions[t[0]].cast<double>(), mesh.positions[t[1]].cast<double>(),
          mesh.positions[t[2]].cast<double>()};
}

/// Embree's tree over the triangles of a mesh, which must outlive it. Threads: const members from any.
class MeshTree {
 public:
  /// @pre  indices in range, positions finite
  explicit MeshTree(const IndexedMesh& mesh);

  struct Nearest {
    double distance_mm;
    std::uint32_t triangle;
  };
  /// The exact distance to the nearest triangle. @pre there is one @param bound_mm  the distance is not above it
  [[nodiscard]] Nearest nearest(const Eigen::Vector3d& p, double bound_mm) const;

  /// The side that the first triangle along a ray turns to the point; outside where there is none. Right for a network
  /// that is closed and does not run through itself.
  [[nodiscard]] Label label_at(const Eigen::Vector3d& p) const;

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };

  const IndexedMesh& mesh_;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
};

}  // namespace sonoloft
