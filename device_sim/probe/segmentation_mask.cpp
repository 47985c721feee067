#include "device_sim/probe/segmentation_mask.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sonoloft::device_sim {
namespace {

using protocol::Contour;
using protocol::MaskGrid;
using protocol::Point;
using protocol::WireLabel;

Eigen::AlignedBox2d box_of(std::span<const Point> points) {
  Eigen::AlignedBox2d box;
  for (const Point& p : points) box.extend(Eigen::Vector2d(p.x_px, p.y_px));
  return box;
}

MaskGrid grid_over(const Eigen::AlignedBox2d& box, std::uint16_t pixels) {
  if (box.isEmpty()) return {0, 0, 1, 1, 1};
  const Eigen::Vector2d size = box.sizes().cwiseMax(1);
  const double step = size.maxCoeff() / pixels;
  const auto count = [&](double length) {
    return static_cast<std::uint16_t>(std::clamp(std::ceil(length / step - 1e-6), 1.0, static_cast<double>(pixels)));
  };
  const Eigen::Vector2d first = box.min().array() + step / 2;
  return {static_cast<float>(first.x()), static_cast<float>(first.y()), static_cast<float>(step), count(size.x()),
          count(size.y())};
}

// Points in pixels of the grid.
std::vector<Eigen::Vector2d> in_grid(std::span<const Point> points, const MaskGrid& grid) {
  std::vector<Eigen::Vector2d> result;
  result.reserve(points.size());
  for (const Point& p : points) {
    result.emplace_back((double{p.x_px} - grid.x_px) / grid.step_px, (double{p.y_px} - grid.y_px) / grid.step_px);
  }
  return result;
}

double area_of(std::span<const Eigen::Vector2d> loop) {
  double twice = 0;
  for (std::size_t i = 0, before = loop.size() - 1; i < loop.size(); before = i++) {
    twice += loop[before].x() * loop[i].y() - loop[i].x() * loop[before].y();
  }
  return std::abs(twice) / 2;
}

class Canvas {
 public:
  explicit Canvas(const MaskGrid& grid)
      : width_(grid.width), labels_(std::size_t{grid.width} * grid.height), crossings_(grid.height) {}

  void fill(std::span<const Eigen::Vector2d> loop, WireLabel label) {
    for (std::size_t i = 0, before = loop.size() - 1; i < loop.size(); before = i++) cross(loop[before], loop[i]);
    for (std::size_t row = 0; row < crossings_.size(); ++row) fill_row(row, label);
  }

  [[nodiscard]] std::vector<protocol::MaskRun> runs() const {
    constexpr std::uint16_t kLongest = 0xFFFF;
    std::vector<protocol::MaskRun> runs;
    for (const WireLabel label : labels_) {
      if (runs.empty() || runs.back().label != label || runs.back().count == kLongest) runs.push_back({0, label});
      ++runs.back().count;
    }
    return runs;
  }

 private:
  // The rows whose centres lie in [lower end, upper end) of an edge.
  void cross(Eigen::Vector2d a, Eigen::Vector2d b) {
    if (a.y() > b.y()) std::swap(a, b);
    const double last = std::min(std::ceil(b.y()), static_cast<double>(crossings_.size()));
    for (double y = std::max(std::ceil(a.y()), 0.0); y < last; ++y) {
      const double t = (y - a.y()) / (b.y() - a.y());
      crossings_[static_cast<std::size_t>(y)].push_back(a.x() + t * (b.x() - a.x()));
    }
  }

  void fill_row(std::size_t row, WireLabel label) {
    auto& at = crossings_[row];
    std::sort(at.begin(), at.end());
    const auto column = [&](double x) { return static_cast<std::ptrdiff_t>(std::clamp(std::ceil(x), 0.0, width_)); };
    const auto first = labels_.begin() + static_cast<std::ptrdiff_t>(row) * static_cast<std::ptrdiff_t>(width_);
    for (std::size_t i = 0; i + 1 < at.size(); i += 2)
      std::fill(first + column(at[i]), first + column(at[i + 1]), label);
    at.clear();
  }

  const double width_;
  std::vector<WireLabel> labels_;
  std::vector<std::vector<double>> crossings_;  ///< [rows] of the loop at hand
};

}  // namespace

SegmentationMask paint_mask(std::span<const Point> points, std::span<const Contour> contours,
                            std::span<const Point> field_of_view, std::uint16_t pixels) {
  Eigen::AlignedBox2d box = box_of(field_of_view.empty() ? points : field_of_view);
  if (field_of_view.empty() && !box.isEmpty()) {
    const double margin = box.sizes().maxCoeff() / 8;
    box = {box.min().array() - margin, box.max().array() + margin};
  }
  const MaskGrid grid = grid_over(box, pixels);
  const auto placed = in_grid(points, grid);
  struct Loop {
    std::span<const Eigen::Vector2d> points;
    double area;
    WireLabel label;
  };
  std::vector<Loop> loops;
  for (const Contour& c : contours) {
    const auto loop = std::span(placed).subspan(c.first, c.count);
    const bool hole = (c.flags & protocol::kHoleFlag) != 0;
    loops.push_back({loop, area_of(loop), hole ? WireLabel{0} : c.label});
  }
  std::stable_sort(loops.begin(), loops.end(), [](const Loop& a, const Loop& b) { return a.area > b.area; });
  Canvas canvas(grid);
  for (const Loop& loop : loops) canvas.fill(loop.points, loop.label);
  return {grid, canvas.runs()};
}

}  // namespace sonoloft::device_sim
