#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sonoloft {

/// Calls visit(from, to) for every piece that the planes of whole numbers, in all three axes, cut out of the segment
/// a b: shares 0..1 of its length, ascending. A piece lies in the cube that its middle lies in.
/// Source: Amanatides, Woo 1987.
template <class Visit>
void walk_grid(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Visit visit) {
  const Eigen::Vector3d step = b - a;
  Eigen::Vector3d next;  // share of the length at which the next plane of each axis is met
  for (int axis = 0; axis < 3; ++axis) {
    const double plane = step[axis] > 0.0 ? std::floor(a[axis]) + 1.0 : std::ceil(a[axis]) - 1.0;
    next[axis] = step[axis] == 0.0 ? std::numeric_limits<double>::infinity() : (plane - a[axis]) / step[axis];
  }
  for (double from = 0.0; from < 1.0;) {
    int axis = 0;
    const double to = std::min(1.0, next.minCoeff(&axis));
    if (to > from) visit(from, to);
    from = std::max(from, to);
    next[axis] += 1.0 / std::abs(step[axis]);
  }
}

}  // namespace sonoloft
