#include "core/slopes/contour/fading.h"

#include <algorithm>
#include <cmath>

#include "core/slopes/windows.h"

namespace sonoloft {
namespace {

/// The greatest value of u^2 / (2 + u^4).
const double kPeak = std::sqrt(2.0) / 4;

/// The radius of the largest ball that touches the border at a point from the side of `towards` and no other border,
/// up to `most_mm`: halfway to a border that faces it.
double free_radius(const BorderTree& borders, const Eigen::Vector2d& point, const Eigen::Vector2d& towards,
                   double most_mm) {
  constexpr double kTouches = 0.6;  // of the radius: nearer than a rough contour comes to it around the point itself
  std::uint32_t hint = 0;
  for (const double radius : {0.125 * most_mm, 0.25 * most_mm, 0.5 * most_mm, most_mm}) {
    const auto other = borders.nearest(point + radius * towards, kTouches * radius, std::nullopt, hint);
    if (other) return 0.5 * (radius + static_cast<double>(other->distance_mm));
  }
  return most_mm;
}

double fading_at(const BorderTree& borders, const Eigen::Vector2d& point, const Eigen::Vector2d& outward,
                 double curvature, double feature_mm) {
  if (curvature == 0) return 0;
  const double bulge_mm = kPeak / std::abs(curvature);
  const double most_mm = std::min(bulge_mm / kShareOfClearance, kClearanceReach * feature_mm);
  const double free_mm = free_radius(borders, point, std::copysign(1.0, curvature) * outward, most_mm);
  return std::abs(curvature) *
         std::sqrt(std::max(1.0, free_mm < most_mm ? bulge_mm / (kShareOfClearance * free_mm) : 1.0));
}

}  // namespace

std::vector<float> fading_of(const Section& section, const Arcs& arcs, const ArcShape& shape,
                             std::span<const std::uint8_t> is_station, const BorderTree& borders, double feature_mm) {
  std::vector<float> fading(arcs.point.size(), 0.0f);
  for (const Arc& arc : arcs.arcs) {
    if (!arc.is_surface()) continue;
    std::uint32_t last = arc.first;
    const auto between = [&](std::uint32_t end, float at_end, double end_mm) {
      const double begin_mm = arcs.along_mm[last], way = end_mm - begin_mm;
      for (std::uint32_t place = last + 1; place < end; ++place) {
        const auto share = static_cast<float>(way > 0 ? (arcs.along_mm[place] - begin_mm) / way : 0);
        fading[place] = fading[last] + share * (at_end - fading[last]);
      }
    };
    for (std::uint32_t place = arc.first; place < arc.end(); ++place) {
      if (!is_station[place]) continue;
      fading[place] =
          static_cast<float>(fading_at(borders, section.points[arcs.point[place]], shape.outward[place].cast<double>(),
                                       static_cast<double>(shape.curvature_per_mm[place]), feature_mm));
      between(place, fading[place], arcs.along_mm[place]);
      last = place;
    }
    between(arc.end(), arc.closed ? fading[arc.first] : fading[last], arc.length_mm);
  }
  for (std::size_t place = 0; place < fading.size(); ++place)
    fading[place] = std::max(fading[place], std::abs(shape.curvature_per_mm[place]));
  return fading;
}

}  // namespace sonoloft
