#pragma once
#include <Eigen/Geometry>
#include <cstddef>

namespace sonoloft {

/// Nodes of a square grid at spacing * (first + (x, y) + 1/2), x fastest. Frame: a stack's, mm.
struct PlaneGrid {
  double spacing_mm = 1;
  Eigen::Vector2i first = Eigen::Vector2i::Zero();
  int width = 0, height = 0;

  /// Over a box and `margin` nodes more on every side.
  static PlaneGrid over(const Eigen::AlignedBox2d& box, double spacing_mm, int margin) {
    const Eigen::Vector2i low = (box.min() / spacing_mm).array().floor().cast<int>() - margin,
                          high = (box.max() / spacing_mm).array().ceil().cast<int>() + margin;
    return {spacing_mm, low, high.x() - low.x(), high.y() - low.y()};
  }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] Eigen::Vector2i node(std::size_t index) const {
    const auto i = static_cast<int>(index);
    return {i % width, i / width};
  }
  [[nodiscard]] Eigen::Vector2d point(int x, int y) const {
    return spacing_mm * (first.cast<double>() + Eigen::Vector2d(x + 0.5, y + 0.5));
  }
};

}  // namespace sonoloft
