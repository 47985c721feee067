#include "core/reconstructor/stack_caps.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace sonoloft {
namespace {

struct Place {
  double along_mm;
  const Eigen::Isometry3d* frame;
};

/// @param places  from an end inwards
std::vector<Eigen::Isometry3d> beyond(std::span<const Place> places, const Eigen::Vector3d& normal, double gaps,
                                      double least_mm) {
  const Place& last = places.front();
  const auto inner = std::ranges::find_if(
      places, [&](const Place& place) { return std::abs(place.along_mm - last.along_mm) > least_mm; });
  if (inner == places.end()) return {};
  const double gap_mm = last.along_mm - inner->along_mm;
  Eigen::Isometry3d cap = *last.frame;
  cap.translation() += std::copysign(std::max(gaps * std::abs(gap_mm), least_mm), gap_mm) * normal;
  return {cap};
}

}  // namespace

std::vector<Eigen::Isometry3d> stack_caps(std::span<const Eigen::Isometry3d> frames, double gaps, double least_mm) {
  assert(gaps >= 0 && least_mm > 0);
  if (frames.empty()) return {};
  static const double kLeastCosine = std::cos(std::numbers::pi / 180);
  const Eigen::Vector3d normal = frames.front().linear().col(2);
  std::vector<Place> places;
  for (const Eigen::Isometry3d& frame : frames) {
    if (std::abs(normal.dot(frame.linear().col(2))) < kLeastCosine) return {};
    places.push_back({normal.dot(frame.translation()), &frame});
  }
  std::ranges::stable_sort(places, {}, &Place::along_mm);
  std::vector<Eigen::Isometry3d> caps = beyond(places, normal, gaps, least_mm);
  std::ranges::reverse(places);
  for (const Eigen::Isometry3d& cap : beyond(places, normal, gaps, least_mm)) caps.push_back(cap);
  return caps;
}

}  // namespace sonoloft
