#pragma once
// What of a plane the probe sees:  trajectory, phantom -> [FIELD OF VIEW] -> simulated probe
#include <Eigen/Geometry>
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

/// The sector as a closed polygon: the far arc from left to right, then the near one back; a corner about every degree.
/// Behind the first border of a loop whose label is among `shadowing` the far arc is drawn in to `kShadowSkinMm`
/// behind that border: what lies in the shadow is outside of the polygon.
/// @param section in the frame of the face
[[nodiscard]] std::vector<Eigen::Vector2d> field_of_view(const Sector& sector, const PhantomSection& section,
                                                         std::span<const Label> shadowing);
inline constexpr double kShadowSkinMm = 2;

/// Whether a loop and a polygon have any point in common.
[[nodiscard]] bool overlaps(std::span<const Eigen::Vector2d> loop, std::span<const Eigen::Vector2d> polygon);

}  // namespace sonoloft::device_sim
