#include "core/slopes/contour/arc_shape.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/slopes/windows.h"

namespace sonoloft {
namespace {

using Eigen::Vector2d;

/// Walks along an arc; steps are cheap when they are short.
class ArcWalk {
 public:
  ArcWalk(const Arcs& arcs, const Arc& arc) : arcs_(arcs), arc_(arc) {}

  /// The place before `along_mm` and the one after, and how far between them.
  struct Spot {
    std::uint32_t before, after;
    double share, along_mm;  ///< along_mm within the arc's ends
  };
  Spot to(double along_mm) {
    if (!arc_.closed) along_mm = std::clamp(along_mm, 0.0, arc_.length_mm);
    while (along_mm < begin()) back();
    while (along_mm > end()) forward();
    const std::uint32_t place = arc_.first + step_;
    const double way = end() - begin();
    return {place, arc_.next(place), way > 0 ? (along_mm - begin()) / way : 0, along_mm};
  }

 private:
  [[nodiscard]] std::uint32_t edges() const { return arc_.closed ? arc_.count : arc_.count - 1; }
  [[nodiscard]] double begin() const { return lap_mm_ + arcs_.along_mm[arc_.first + step_]; }
  [[nodiscard]] double end() const {
    return lap_mm_ + (step_ + 1 == arc_.count ? arc_.length_mm : arcs_.along_mm[arc_.first + step_ + 1]);
  }
  void forward() {
    if (++step_ < edges()) return;
    step_ = 0;
    lap_mm_ += arc_.length_mm;
  }
  void back() {
    if (step_-- > 0) return;
    step_ = edges() - 1;
    lap_mm_ -= arc_.length_mm;
  }

  const Arcs& arcs_;
  const Arc& arc_;
  std::uint32_t step_ = 0;
  double lap_mm_ = 0;
};

/// The direction of an arc, and where along it: not at the place itself when the window ended with the arc.
struct Tangent {
  Vector2d direction;
  double offset_mm;
};

double angle(const Vector2d& from, const Vector2d& to) {
  return std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
}

class ArcMeasure {
 public:
  ArcMeasure(const Section& section, const Arcs& arcs, const Arc& arc, double feature_mm)
      : section_(section), arcs_(arcs), arc_(arc), feature_mm_(feature_mm) {}

  void measure(ArcShape& shape) {
    find_tangents();
    const bool bends = arc_.closed || arc_.length_mm >= kShortestOpenArc * feature_mm_;
    ArcWalk before(arcs_, arc_), after(arcs_, arc_);
    for (std::uint32_t i = 0; i < arc_.count; ++i) {
      const double curvature = curvature_at(arcs_.along_mm[arc_.first + i], before, after);
      const double turned = -curvature * tangents_[i].offset_mm;
      const Vector2d t = Eigen::Rotation2Dd(turned) * tangents_[i].direction;
      shape.outward[arc_.first + i] = Eigen::Vector2f(static_cast<float>(t.y()), static_cast<float>(-t.x()));
      shape.curvature_per_mm[arc_.first + i] = bends ? static_cast<float>(curvature) : 0.0f;
    }
  }

 private:
  static constexpr int kChords = 3;

  [[nodiscard]] Vector2d point(const ArcWalk::Spot& spot) const {
    const Vector2d& a = section_.points[arcs_.point[spot.before]];
    return a + spot.share * (section_.points[arcs_.point[spot.after]] - a);
  }

  void find_tangents() {
    const double reach = std::min(kTangentReach * feature_mm_, kTangentReachOfLength * arc_.length_mm);
    std::vector<ArcWalk> walks(2 * kChords, ArcWalk(arcs_, arc_));
    for (std::uint32_t i = 0; i < arc_.count; ++i) {
      const double along = arcs_.along_mm[arc_.first + i];
      Vector2d sum = Vector2d::Zero();
      double weights = 0, offsets = 0;
      for (int c = 1; c <= kChords; ++c) {
        const auto walk = static_cast<std::size_t>(2 * (c - 1));
        const auto from = walks[walk].to(along - c * reach / kChords),
                   to = walks[walk + 1].to(along + c * reach / kChords);
        sum += c * (point(to) - point(from));
        weights += c * (to.along_mm - from.along_mm);
        offsets += c * (to.along_mm - from.along_mm) * (0.5 * (to.along_mm + from.along_mm) - along);
      }
      tangents_.push_back({sum.stableNormalized(), offsets / weights});
    }
  }

  [[nodiscard]] Tangent tangent(const ArcWalk::Spot& spot) const {
    const Tangent &a = tangents_[spot.before - arc_.first], &b = tangents_[spot.after - arc_.first];
    return {a.direction + spot.share * (b.direction - a.direction),
            a.offset_mm + spot.share * (b.offset_mm - a.offset_mm)};
  }

  [[nodiscard]] double curvature_at(double along, ArcWalk& before, ArcWalk& after) const {
    const double reach = std::min(kCurvatureReach * feature_mm_, kCurvatureReachOfLength * arc_.length_mm);
    const auto from = before.to(along - reach), to = after.to(along + reach);
    const Tangent a = tangent(from), b = tangent(to);
    const double way = to.along_mm + b.offset_mm - from.along_mm - a.offset_mm;
    const double greatest = kGreatestCurvature / feature_mm_;
    return std::clamp(angle(a.direction, b.direction) / way, -greatest, greatest);
  }

  const Section& section_;
  const Arcs& arcs_;
  const Arc& arc_;
  double feature_mm_;
  std::vector<Tangent> tangents_;  ///< [#places of the arc]
};

}  // namespace

ArcShape shape_of(const Section& section, const Arcs& arcs, double feature_mm) {
  ArcShape shape{std::vector<Eigen::Vector2f>(arcs.point.size(), Eigen::Vector2f::Zero()),
                 std::vector<float>(arcs.point.size(), 0.0f)};
  for (const Arc& arc : arcs.arcs)
    if (arc.is_surface()) ArcMeasure(section, arcs, arc, feature_mm).measure(shape);
  return shape;
}

}  // namespace sonoloft
