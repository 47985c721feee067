#pragma once
// What of a plane the probe sees:  trajectory, phantom -> [FIELD OF VIEW] -> simulated probe
#include <Eigen/Geometry>
#include <numbers>
#include <span>
#include <vector>

#include "device_sim/probe/phantom.h"
#include "device_sim/probe/trajectory.h"

namespace sonoloft::device_sim {

/// The part of a ring that a curved or phased array sees. Frame: face (apex at the origin, y into the body), mm.
struct Sector {
  double near_mm;
  double far_mm;
  double half_angle_rad;  ///< to both sides of y, below pi / 2
};

/// The smallest sector, with a margin of 2 %, that holds the box's section at every pose.
/// @pre the trajectory is not empty; the box lies in front of the face (y > 0) at every pose
[[nodiscard]] Sector covering_sector(const Eigen::AlignedBox3d& bounds_mm, const Trajectory& trajectory);

/// A small convex array, as for the abdomen of a child.
inline constexpr Sector kConvexArray{4, 62, 30 * std::numbers::pi / 180};

/// The beams whose part of the transducer touches the skin, as shares of the sector's angle from the left.
struct Contact {
  double first = 0, last = 1;  ///< first < last
};

/// What is measured of a sector, as a closed polygon: the far ends of the beams from left to right, then the near arc
/// back. Beams (two a degree) start at the apex. One that meets the border of a loop whose label is among `shadowing`
/// ends `kShadowSkinMm` behind that border; one without contact sees nothing. Thinned by at most 1/2000 of far_mm.
/// Why no loop around each shadow: a smaller loop in it would still count (see PhantomSection).
/// @param section in the frame of the face
/// @cost  O(#points + beams that meet an edge of those labels)
[[nodiscard]] std::vector<Eigen::Vector2d> field_of_view(const Sector& sector, const PhantomSection& section,
                                                         std::span<const Label> shadowing, const Contact& contact = {});
inline constexpr double kShadowSkinMm = 2;

/// Whether a point is within a loop, by even-odd. @pre at least one point
[[nodiscard]] bool encloses(std::span<const Eigen::Vector2d> loop, const Eigen::Vector2d& p);

/// Whether a loop and a polygon have any point in common.
[[nodiscard]] bool overlaps(std::span<const Eigen::Vector2d> loop, std::span<const Eigen::Vector2d> polygon);

}  // namespace sonoloft::device_sim
