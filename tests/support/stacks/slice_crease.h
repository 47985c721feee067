#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "core/methods/stack/layered_field.h"
#include "core/methods/stack/slice_stack.h"

namespace sonoloft::test {

/// The angle, in degrees, between the normals that a field of two labels has just below and just above a slice, at
/// every contour point of the slices that are neither first nor last.
inline std::vector<double> creases_deg(const LayeredField& field, const SliceStack& stack) {
  const PlaneGrid& grid = field.grid();
  const auto layer = [&](double height_mm) {
    std::vector<float> values(2 * grid.size());
    field.layer(height_mm, values);
    return std::vector<float>(values.begin() + static_cast<std::ptrdiff_t>(grid.size()), values.end());
  };
  const auto at = [&](const std::vector<float>& values, const Eigen::Vector2d& p) {
    const Eigen::Vector2d g = (p / grid.spacing_mm - grid.first.cast<double>()).array() - 0.5;
    const int x = static_cast<int>(g.x()), y = static_cast<int>(g.y());
    const double u = g.x() - x, v = g.y() - y;
    const auto value = [&](int i, int j) { return static_cast<double>(values[grid.index(x + i, y + j)]); };
    return (1 - v) * ((1 - u) * value(0, 0) + u * value(1, 0)) + v * ((1 - u) * value(0, 1) + u * value(1, 1));
  };
  std::vector<double> creases;
  for (std::size_t i = 1; i + 1 < stack.sections.size(); ++i) {
    const double z = stack.heights_mm[i];
    const double below_mm = 1e-3 * (z - stack.heights_mm[i - 1]), above_mm = 1e-3 * (stack.heights_mm[i + 1] - z);
    const auto below = layer(z - below_mm), on = layer(z), above = layer(z + above_mm);
    for (const Eigen::Vector2d& p : stack.sections[i].points) {
      const Eigen::Vector2d x(grid.spacing_mm, 0), y(0, grid.spacing_mm);
      const double across =
          std::hypot(at(on, p + x) - at(on, p - x), at(on, p + y) - at(on, p - y)) / (2 * grid.spacing_mm);
      const double lean_below = std::atan((at(on, p) - at(below, p)) / (below_mm * across)),
                   lean_above = std::atan((at(above, p) - at(on, p)) / (above_mm * across));
      creases.push_back(std::abs(lean_above - lean_below) * 180 / std::numbers::pi);
    }
  }
  return creases;
}

}  // namespace sonoloft::test
