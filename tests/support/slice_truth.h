#pragma once
// The rule of TrackedSlice, told without grid, splitting or sweep: what a section is measured against.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/slice/tracked_slice.h"

namespace sonoloft::test {

using Loop = std::span<const Eigen::Vector2d>;

inline Loop loop_of(const TrackedSlice& slice, const Contour& c) {
  return Loop(slice.points).subspan(c.first, c.count);
}

/// The heights at which a vertical line crosses a loop, ascending.
inline std::vector<double> crossings_at(Loop loop, double x) {
  std::vector<double> heights;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d &p = loop[i], &q = loop[(i + 1) % loop.size()];
    if ((p.x() <= x) != (q.x() <= x)) heights.push_back(p.y() + (q.y() - p.y()) * (x - p.x()) / (q.x() - p.x()));
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

inline bool encloses(Loop loop, const Eigen::Vector2d& point) {
  const std::vector<double> heights = crossings_at(loop, point.x());
  const auto below = std::count_if(heights.begin(), heights.end(), [&](double y) { return y < point.y(); });
  return below % 2 == 1;
}

/// Even-odd area, by slabs between all vertices and crossings. O(n^3): for small loops.
inline double enclosed_area(Loop loop) {
  std::vector<double> x;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d &a = loop[i], d = loop[(i + 1) % loop.size()] - a;
    x.push_back(a.x());
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector2d &b = loop[j], e = loop[(j + 1) % loop.size()] - b;
      const double det = d.x() * e.y() - d.y() * e.x();
      const double t = ((b - a).x() * e.y() - (b - a).y() * e.x()) / det;
      if (t > 0 && t < 1) x.push_back(a.x() + t * d.x());
    }
  }
  std::sort(x.begin(), x.end());
  double area = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const std::vector<double> heights = crossings_at(loop, 0.5 * (x[i] + x[i + 1]));
    for (std::size_t k = 0; k + 1 < heights.size(); k += 2) area += (heights[k + 1] - heights[k]) * (x[i + 1] - x[i]);
  }
  return area;
}

/// Tells labels by the rule; areas are measured once.
class SliceTruth {
 public:
  explicit SliceTruth(const TrackedSlice& slice) : slice_(slice) {
    for (const Contour& c : slice.contours) areas_.push_back(enclosed_area(loop_of(slice, c)));
  }

  Label label_at(const Eigen::Vector2d& point) const {
    if (!slice_.field_of_view.empty() && !encloses(slice_.field_of_view, point)) return kUnknown;
    const Contour* smallest = nullptr;
    double smallest_area = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < areas_.size(); ++i) {
      const Contour& c = slice_.contours[i];
      if (!encloses(loop_of(slice_, c), point)) continue;
      const bool equal = std::abs(areas_[i] - smallest_area) <= 1e-9 * areas_[i];
      if (equal ? !smallest->hole || c.hole : areas_[i] > smallest_area) continue;
      smallest = &c;
      smallest_area = areas_[i];
    }
    return smallest == nullptr || smallest->hole ? kOutside : smallest->label;
  }

  /// Distance to the nearest border of a contour or of the field of view.
  double distance_to_border(const Eigen::Vector2d& point) const {
    double nearest = distance(slice_.field_of_view, point);
    for (const Contour& c : slice_.contours) nearest = std::min(nearest, distance(loop_of(slice_, c), point));
    return nearest;
  }

 private:
  static double distance(Loop loop, const Eigen::Vector2d& point) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector2d &a = loop[i], d = loop[(i + 1) % loop.size()] - a;
      const double t = std::clamp((point - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
      nearest = std::min(nearest, (point - a - t * d).norm());
    }
    return nearest;
  }

  const TrackedSlice& slice_;
  std::vector<double> areas_;
};

}  // namespace sonoloft::test
