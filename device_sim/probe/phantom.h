#pragma once
// Far side of the cable:  [PHANTOM] -> section -> simulated probe -> firmware
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/slice.h"

namespace sonoloft::device_sim {

using Label = protocol::WireLabel;  ///< 0 outside, 1.. materials
inline constexpr Label kOutside = 0;
inline constexpr Label kFirstReservedLabel = 0xFFF1;  ///< this and what is above it are no materials

/// One closed loop of a section: the points [first, first + count), the last joined to the first.
struct SectionLoop {
  std::uint32_t first;
  std::uint32_t count;  ///< at least 3
  Label label;          ///< of a hole it is kOutside
  bool hole;            ///< encloses outside
};

/// What a plane cuts out of a phantom. The label of a point is the label of the smallest loop (by area) that encloses
/// it by even-odd, outside where none does. Two loops that share a border have identical points along it.
/// Frame: plane, mm.
struct PhantomSection {
  std::vector<Eigen::Vector2d> points;
  std::vector<SectionLoop> loops;                ///< loop i + 1 starts where loop i ends
  std::vector<Eigen::Vector2d> field_of_view{};  ///< of a recorded one, closed polygon; empty: the whole plane was seen
};

/// Anything that can be cut by a plane. Threads: const members may run together.
class SectionSource {
 public:
  virtual ~SectionSource() = default;
  /// A box that holds everything that is not outside. Frame: reference, mm.
  [[nodiscard]] virtual Eigen::AlignedBox3d bounds() const = 0;
  /// The section with the plane z = 0 of the plane frame.
  /// @post all loops are closed, have at least 3 points and an area above 0
  [[nodiscard]] virtual PhantomSection section(const Eigen::Isometry3d& plane_to_reference) const = 0;
  /// The same where only a window of the plane is looked at, which may cost less: beyond it loops may run as they like.
  [[nodiscard]] virtual PhantomSection section_in(const Eigen::AlignedBox2d& /*window*/,
                                                  const Eigen::Isometry3d& plane_to_reference) const {
    return section(plane_to_reference);
  }
};

/// A body whose label is known everywhere: the truth that a reconstruction is measured against.
class Phantom : public SectionSource {
 public:
  /// Frame: reference, mm.
  [[nodiscard]] virtual Label label_at(const Eigen::Vector3d& point_mm) const = 0;
};

/// What a factory over outside input returns: a value, or one line that names the cause and the remedy.
template <class T>
struct Made {
  std::unique_ptr<T> value;
  std::string error;  ///< empty if and only if there is a value
};

/// The area of a closed loop, positive if it runs counter-clockwise. @pre at least one point
[[nodiscard]] double signed_area(std::span<const Eigen::Vector2d> loop);

/// The corners of the polygon in which a plane cuts a box, in no particular order, none where they do not meet.
/// Frame: plane, mm.
[[nodiscard]] std::vector<Eigen::Vector2d> box_section(const Eigen::AlignedBox3d& box,
                                                       const Eigen::Isometry3d& plane_to_reference);

}  // namespace sonoloft::device_sim
