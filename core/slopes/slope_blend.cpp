#include "core/slopes/slope_blend.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "core/slopes/windows.h"

namespace sonoloft {
namespace {

/// The slopes along one arc.
class ArcSlopes {
 public:
  ArcSlopes(SliceContours& contours, std::uint32_t arc, double feature_mm)
      : contours_(contours), arc_(contours.arcs.arcs[arc]), reach_mm_(kSmoothingReach * feature_mm) {
    if (arc_.closed) reach_mm_ = std::min(reach_mm_, 0.5 * arc_.length_mm);
    find_stations();
    find_crossings(arc);
  }

  void compute() {
    std::size_t first = 0;
    for (std::uint32_t place = arc_.first; place < arc_.end(); ++place) {
      const double along = contours_.arcs.along_mm[place];
      while (first < stations_.size() && stations_[first].along_mm <= along - reach_mm_) ++first;
      const Guess planes = from_planes(along, first);
      const Guess crossings = from_crossings(along);
      const double weight = crossings_.empty() ? 0 : 1 / (1 + crossings.distance2 * planes.nearness2);
      const double slope = std::tan(weight * crossings.angle + (1 - weight) * planes.angle);
      contours_.slope[place] = static_cast<float>(std::clamp(slope, -kGreatestSlope, kGreatestSlope));
    }
  }

 private:
  /// A place that has planes around it.
  struct Station {
    double along_mm, span_mm;  ///< span: to the stations before and after
    double angle, nearness2;
    bool has_angle;
  };
  struct Guess {
    double angle = 0, nearness2 = 0, distance2 = 0;
  };

  void find_stations() {
    std::vector<std::uint32_t> places;
    for (std::uint32_t place = arc_.first; place < arc_.end(); ++place)
      if (contours_.is_station[place]) places.push_back(place);
    const auto along = [&](std::size_t i) { return contours_.arcs.along_mm[places[i]]; };
    const double lap = arc_.closed ? arc_.length_mm : 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto& [below, above] = contours_.sums[places[i]];
      const double weights = static_cast<double>(below.weights) + static_cast<double>(above.weights);
      if (below.cell == kNoCell && above.cell == kNoCell) continue;
      const double before = i > 0 ? along(i - 1) : arc_.closed ? along(places.size() - 1) - lap : along(i);
      const double after = i + 1 < places.size() ? along(i + 1) : arc_.closed ? along(0) + lap : along(i);
      const double slopes = static_cast<double>(below.slopes) + static_cast<double>(above.slopes);
      const bool has_angle = weights > 0;
      stations_.push_back({along(i), after - before, has_angle ? std::atan(slopes / weights) : 0,
                           static_cast<double>(std::max(below.nearness2_per_mm2, above.nearness2_per_mm2)), has_angle});
    }
    if (arc_.closed) unroll(stations_);
  }

  void find_crossings(std::uint32_t arc) {
    const auto range = std::equal_range(contours_.crossings.begin(), contours_.crossings.end(), Crossing{arc, 0, 0, {}},
                                        [](const Crossing& l, const Crossing& r) { return l.arc < r.arc; });
    crossings_.assign(range.first, range.second);
    if (arc_.closed) unroll(crossings_);
  }

  /// Goes round once more before and after.
  template <class Along>
  void unroll(std::vector<Along>& items) const {
    const std::size_t count = items.size();
    std::vector<Along> rolled;
    rolled.reserve(3 * count);
    for (const double lap : {-arc_.length_mm, 0.0, arc_.length_mm})
      for (Along item : items) {
        item.along_mm = static_cast<decltype(item.along_mm)>(item.along_mm + lap);
        rolled.push_back(item);
      }
    items = std::move(rolled);
  }

  [[nodiscard]] Guess from_planes(double along, std::size_t first) const {
    double weights = 0, angle_weights = 0;
    Guess sum;
    for (std::size_t i = first; i < stations_.size() && stations_[i].along_mm < along + reach_mm_; ++i) {
      const Station& s = stations_[i];
      const double weight = (1 - std::abs(s.along_mm - along) / reach_mm_) * s.span_mm;
      weights += weight;
      sum.nearness2 += weight * s.nearness2;
      if (!s.has_angle) continue;
      angle_weights += weight;
      sum.angle += weight * s.angle;
    }
    return {angle_weights > 0 ? sum.angle / angle_weights : 0, weights > 0 ? sum.nearness2 / weights : 0, 0};
  }

  [[nodiscard]] Guess from_crossings(double along) const {
    if (crossings_.empty()) return {};
    const auto after = std::lower_bound(crossings_.begin(), crossings_.end(), along,
                                        [](const Crossing& c, double s) { return c.along_mm < s; });
    const Crossing& b = after == crossings_.end() ? crossings_.back() : *after;
    const Crossing& a = after == crossings_.begin() ? b : *(after - 1);
    const double way = b.along_mm - a.along_mm;
    const double share = way > 0 ? std::clamp((along - a.along_mm) / way, 0.0, 1.0) : 0;
    const double distance = std::min(std::abs(along - a.along_mm), std::abs(along - b.along_mm));
    return {a.angle + share * (b.angle - a.angle), 0, distance * distance};
  }

  SliceContours& contours_;
  const Arc& arc_;
  double reach_mm_;
  std::vector<Station> stations_;
  std::vector<Crossing> crossings_;
};

/// The end of an open arc.
struct ArcEnd {
  std::uint32_t point, place;
};

std::vector<ArcEnd> ends_of(const Arcs& arcs) {
  std::vector<ArcEnd> ends;
  for (const Arc& arc : arcs.arcs)
    if (arc.is_surface() && !arc.closed)
      for (const std::uint32_t place : {arc.first, arc.end() - 1}) ends.push_back({arcs.point[place], place});
  std::sort(ends.begin(), ends.end(),
            [](const ArcEnd& l, const ArcEnd& r) { return std::tie(l.point, l.place) < std::tie(r.point, r.place); });
  return ends;
}

/// Where surfaces meet: the displacement per height that suits the slopes of all of them best.
VertexBend bend_of_junction(const SliceContours& contours, std::span<const ArcEnd> ends) {
  constexpr float kStiffness = 0.01f;  // keeps the system regular where all arcs leave along one line
  Eigen::Matrix2f squares = kStiffness * Eigen::Matrix2f::Identity();
  Eigen::Vector2f products = Eigen::Vector2f::Zero();
  for (const ArcEnd& end : ends) {
    const Eigen::Vector2f& outward = contours.shape.outward[end.place];
    squares += outward * outward.transpose();
    products += contours.slope[end.place] * outward;
  }
  const Eigen::Vector2f move = squares.inverse() * products;
  const float slope = move.norm();
  if (!(slope > 0)) return {};
  return {move / slope, std::min(slope, static_cast<float>(kGreatestSlope)), 0, 0};
}

VertexBend bend_of_place(const SliceContours& contours, std::uint32_t place) {
  return {contours.shape.outward[place], contours.slope[place], contours.shape.curvature_per_mm[place],
          contours.fading_per_mm[place]};
}

}  // namespace

void blend(SliceContours& contours, double feature_mm) {
  const Arcs& arcs = contours.arcs;
  std::sort(contours.crossings.begin(), contours.crossings.end(), [](const Crossing& l, const Crossing& r) {
    return std::tie(l.arc, l.along_mm, l.other, l.angle) < std::tie(r.arc, r.along_mm, r.other, r.angle);
  });
  for (std::uint32_t i = 0; i < arcs.arcs.size(); ++i)
    if (contours.arc_is_stale[i] && arcs.arcs[i].is_surface()) ArcSlopes(contours, i, feature_mm).compute();
  std::fill(contours.arc_is_stale.begin(), contours.arc_is_stale.end(), std::uint8_t{0});
  for (std::uint32_t place = 0; place < arcs.point.size(); ++place)
    if (arcs.arc_at(place).is_surface()) contours.bends[arcs.point[place]] = bend_of_place(contours, place);
  const std::vector<ArcEnd> ends = ends_of(arcs);
  for (auto first = ends.begin(); first != ends.end();) {
    const auto last = std::find_if(first, ends.end(), [&](const ArcEnd& end) { return end.point != first->point; });
    if (last - first > 1) contours.bends[first->point] = bend_of_junction(contours, {first, last});
    first = last;
  }
}

}  // namespace sonoloft
