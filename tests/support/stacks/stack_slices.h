#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "core/slice/tracked_slice.h"

/// Parallel slices for tests.
namespace sonoloft::test {

using Loop2d = std::vector<Eigen::Vector2d>;

inline Loop2d ellipse(const Eigen::Vector2d& centre, double rx, double ry, int corners = 180) {
  Loop2d loop;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    loop.emplace_back(centre.x() + rx * std::cos(angle), centre.y() + ry * std::sin(angle));
  }
  return loop;
}

inline Loop2d circle(const Eigen::Vector2d& centre, double radius, int corners = 180) {
  return ellipse(centre, radius, radius, corners);
}

inline Loop2d rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

inline void add_loop(TrackedSlice& slice, const Loop2d& loop, Label label) {
  slice.contours.push_back(
      {static_cast<std::uint32_t>(slice.points.size()), static_cast<std::uint32_t>(loop.size()), label, false});
  slice.points.insert(slice.points.end(), loop.begin(), loop.end());
}

/// A slice at z = height with contours of label 1.
inline TrackedSlice slice_at(double height_mm, const std::vector<Loop2d>& loops) {
  TrackedSlice slice;
  slice.image_to_reference = Eigen::Translation3d(0, 0, height_mm);
  for (const Loop2d& loop : loops) add_loop(slice, loop, 1);
  return slice;
}

}  // namespace sonoloft::test
