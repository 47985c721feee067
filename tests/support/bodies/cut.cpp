#include "tests/support/bodies/cut.h"

#include <map>
#include <utility>

#include "device_sim/probe/random.h"

namespace sonoloft::test {

TrackedSlice cut(const device_sim::SectionSource& body, const Eigen::Isometry3d& plane, std::uint64_t id) {
  device_sim::PhantomSection section = body.section(plane);
  TrackedSlice slice;
  slice.id = id;
  slice.image_to_reference = plane;
  slice.points = std::move(section.points);
  for (const device_sim::SectionLoop& loop : section.loops)
    slice.contours.push_back({loop.first, loop.count, loop.label, loop.hole});
  return slice;
}

std::vector<TrackedSlice> cut(const device_sim::SectionSource& body, std::span<const Eigen::Isometry3d> planes) {
  std::vector<TrackedSlice> slices;
  for (const Eigen::Isometry3d& plane : planes) slices.push_back(cut(body, plane, slices.size()));
  return slices;
}

std::vector<TrackedSlice> with_noise(std::vector<TrackedSlice> slices, double sigma_mm, std::uint64_t seed) {
  for (std::size_t i = 0; i < slices.size(); ++i) {
    device_sim::Random random(seed, i);
    std::map<std::pair<double, double>, Eigen::Vector2d> moved;
    for (Eigen::Vector2d& p : slices[i].points) {
      const auto [found, is_new] = moved.try_emplace({p.x(), p.y()});
      if (is_new) {
        const double x = random.normal();
        found->second = p + sigma_mm * Eigen::Vector2d(x, random.normal());
      }
      p = found->second;
    }
  }
  return slices;
}

}  // namespace sonoloft::test
