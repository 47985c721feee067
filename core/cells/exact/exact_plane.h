#pragma once
#include <Eigen/Core>

namespace sonoloft {

/// { x : normal . x + offset = 0 }, taken exactly as these four doubles say. mm.
struct Plane {
  Eigen::Vector3d normal;
  double offset;
  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    return normal.x() * p.x() + normal.y() * p.y() + normal.z() * p.z() + offset;
  }
};

/// The common point of three planes, correct to a few units in the last place of `scale`.
/// @pre the planes meet in one point; scale: upper bound of the coordinates' size, mm
[[nodiscard]] Eigen::Vector3d meet(const Plane& a, const Plane& b, const Plane& c, double scale);

/// The sign (-1, 0, +1) of plane.distance at the common point of a, b, c, decided exactly.
/// @param approx what meet(a, b, c, scale) gave: almost always decides without exact arithmetic
[[nodiscard]] int side_of_plane(const Plane& a, const Plane& b, const Plane& c, const Eigen::Vector3d& approx,
                                double scale, const Plane& plane);

}  // namespace sonoloft
