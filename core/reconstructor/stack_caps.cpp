#include "core/reconstructor/stack_caps.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace sonoloft {

std::vector<TrackedSlice> stack_caps(std::span<const TrackedSlice> slices, double gaps, double least_mm) {
  assert(gaps >= 0 && least_mm > 0);
  if (slices.size() < 2) return {};
  static const double kLeastCosine = std::cos(std::numbers::pi / 180);
  const Eigen::Vector3d normal = slices.front().image_to_reference.linear().col(2);
  struct Place {
    double along_mm;
    const TrackedSlice* slice;
  };
  std::vector<Place> places;
  for (const TrackedSlice& slice : slices) {
    if (std::abs(normal.dot(slice.image_to_reference.linear().col(2))) < kLeastCosine) return {};
    places.push_back({normal.dot(slice.image_to_reference.translation()), &slice});
  }
  std::sort(places.begin(), places.end(), [](const Place& l, const Place& r) { return l.along_mm < r.along_mm; });
  const auto beyond = [&](const Place& last, const Place& inner) {
    const double gap_mm = last.along_mm - inner.along_mm;
    TrackedSlice cap;
    cap.id = last.slice->id;
    cap.time = last.slice->time;
    cap.image_to_reference = last.slice->image_to_reference;
    cap.image_to_reference.translation() += std::copysign(std::max(gaps * std::abs(gap_mm), least_mm), gap_mm) * normal;
    return cap;
  };
  return {beyond(places.front(), places[1]), beyond(places.back(), places[places.size() - 2])};
}

}  // namespace sonoloft
