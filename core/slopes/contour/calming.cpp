#include "core/slopes/contour/calming.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/slopes/windows.h"

namespace sonoloft {
namespace {

using Eigen::Vector2d;

constexpr int kLeastPoints = 6;             ///< fewer say nothing of their noise
constexpr double kMedianOfNormal = 0.6745;  ///< of the absolute value, over the standard deviation

/// The points of an arc by whole numbers; of a closed one all of these, lap after lap.
class ArcPoints {
 public:
  ArcPoints(const Section& section, const Arcs& arcs, const Arc& arc)
      : section_(section), arcs_(arcs), arc_(arc), count_(static_cast<int>(arc.count)) {}

  [[nodiscard]] bool has(int i) const { return arc_.closed || (i >= 0 && i < count_); }
  [[nodiscard]] const Vector2d& point(int i) const { return section_.points[arcs_.point[place(i)]]; }
  [[nodiscard]] double along_mm(int i) const { return arcs_.along_mm[place(i)] + lap(i) * arc_.length_mm; }
  /// The way from halfway to the point before to halfway to the one after, doubled.
  [[nodiscard]] double span_mm(int i) const {
    return along_mm(has(i + 1) ? i + 1 : i) - along_mm(has(i - 1) ? i - 1 : i);
  }

 private:
  [[nodiscard]] int lap(int i) const { return i < 0 ? (i + 1) / count_ - 1 : i / count_; }
  [[nodiscard]] std::uint32_t place(int i) const {
    return arc_.first + static_cast<std::uint32_t>(i - lap(i) * count_);
  }

  const Section& section_;
  const Arcs& arcs_;
  const Arc& arc_;
  int count_;
};

/// How far a point lies beside the cubic through two points on either side, in standard deviations of one point's
/// noise.
double off_neighbours(const ArcPoints& points, int i) {
  constexpr std::array kAround = {-2, -1, 1, 2};
  Vector2d between = Vector2d::Zero();
  double variance = 1;
  for (const int a : kAround) {
    double weight = 1;
    for (const int b : kAround)
      if (b != a)
        weight *= (points.along_mm(i) - points.along_mm(i + b)) / (points.along_mm(i + a) - points.along_mm(i + b));
    between += weight * points.point(i + a);
    variance += weight * weight;
  }
  const Vector2d along = (points.point(i + 1) - points.point(i - 1)).stableNormalized();
  const Vector2d off = points.point(i) - between;
  return std::abs(along.x() * off.y() - along.y() * off.x()) / std::sqrt(variance);
}

/// The standard deviation of an arc's points across it. The median: corners are no noise.
double noise_mm(const ArcPoints& points, const Arc& arc) {
  const int count = static_cast<int>(arc.count), ends = arc.closed ? 0 : 2;
  std::vector<double> off;
  for (int i = ends; i < count - ends; ++i) off.push_back(off_neighbours(points, i));
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return *middle / kMedianOfNormal;
}

/// Where the line that fits the points around one best has this point; the point itself where there are no others.
Vector2d on_fitted_line(const ArcPoints& points, int i, double reach_mm) {
  double w0 = 0, w1 = 0, w2 = 0;
  Vector2d p0 = Vector2d::Zero(), p1 = Vector2d::Zero();
  const auto add = [&](int k) {
    if (!points.has(k)) return false;
    const double x = (points.along_mm(k) - points.along_mm(i)) / reach_mm;
    if (!(std::abs(x) < 1)) return false;
    const double weight = (1 - x * x) * points.span_mm(k);
    const Vector2d away = points.point(k) - points.point(i);
    w0 += weight, w1 += weight * x, w2 += weight * x * x;
    p0 += weight * away, p1 += weight * x * away;
    return true;
  };
  for (int k = i; add(k); --k) continue;
  for (int k = i + 1; add(k); ++k) continue;
  const double determinant = w0 * w2 - w1 * w1;
  return determinant > 0 ? Vector2d(points.point(i) + (w2 * p0 - w1 * p1) / determinant) : points.point(i);
}

}  // namespace

Section calmed(Section section, const Arcs& arcs, double feature_mm) {
  const Section rough = section;
  for (const Arc& arc : arcs.arcs) {
    if (!arc.is_surface() || arc.count < kLeastPoints) continue;
    const ArcPoints points(rough, arcs, arc);
    const double noise = noise_mm(points, arc);
    const double reach_mm =
        std::min({kCalmingReach * noise, kGreatestCalmingReach * feature_mm, kTangentReachOfLength * arc.length_mm});
    const int count = static_cast<int>(arc.count), ends = arc.closed ? 0 : 1;
    for (int i = ends; i < count - ends; ++i) {
      const Vector2d move = on_fitted_line(points, i, reach_mm) - points.point(i);
      const double share = std::min(1.0, kGreatestCalming * noise / std::max(move.norm(), 1e-300));
      section.points[arcs.point[arc.first + static_cast<std::uint32_t>(i)]] = points.point(i) + share * move;
    }
  }
  return section;
}

}  // namespace sonoloft
