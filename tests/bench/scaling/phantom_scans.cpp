#include "tests/bench/scaling/phantom_scans.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "device_sim/probe/random.h"
#include "tests/support/bodies/cut.h"
#include "tests/support/phantom_section.h"

namespace sonoloft::bench {
namespace {

namespace sim = device_sim;

/// Catmull-Rom: through all points of the loop; t in points.
Eigen::Vector2d on_curve(std::span<const Eigen::Vector2d> loop, double t) {
  const auto i = static_cast<std::size_t>(t);
  const double u = t - static_cast<double>(i);
  const auto at = [&](std::size_t k) { return loop[(i + k + loop.size() - 1) % loop.size()]; };
  const Eigen::Vector2d p = at(0), q = at(1), r = at(2), s = at(3);
  return q + 0.5 * u * ((r - p) + u * ((2 * p - 5 * q + 4 * r - s) + u * (3 * (q - r) + s - p)));
}

}  // namespace

std::vector<TrackedSlice> free_planes(const sim::Phantom& phantom, std::size_t count) {
  const Eigen::AlignedBox3d all = phantom.bounds();
  const Eigen::AlignedBox3d middle(all.center() - 0.25 * all.sizes(), all.center() + 0.25 * all.sizes());
  sim::Random random(11);
  std::vector<TrackedSlice> slices;
  for (std::size_t i = 0; i < count; ++i) slices.push_back(test::cut(phantom, test::random_plane(middle, random), i));
  return slices;
}

std::vector<TrackedSlice> parallel_planes(const sim::Phantom& phantom, std::size_t count) {
  const Eigen::AlignedBox3d all = phantom.bounds();
  std::vector<TrackedSlice> slices;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    Eigen::Isometry3d plane = Eigen::Isometry3d::Identity();
    plane.translation() = all.center() + 0.5 * (share - 0.5) * all.sizes().z() * Eigen::Vector3d::UnitZ();
    slices.push_back(test::cut(phantom, plane, i));
  }
  return slices;
}

sim::SolidPhantom bumpy_body() {
  const Eigen::Isometry3d lying(Eigen::Translation3d(60, 0, 0) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()));
  const Eigen::Isometry3d tilted(Eigen::Translation3d(0, 0, 10) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()));
  return sim::SolidPhantom({sim::ellipsoid(tilted, {70, 45, 85}, 1), sim::torus(lying, 28, 9, 1),
                            sim::sphere({-50, 20, 60}, 30, sim::kOutside),
                            sim::capsule({-20, 0, -40}, {15, 5, 20}, 14, sim::kOutside)});
}

sim::SolidPhantom bead_chain(bool touching) {
  std::vector<sim::Solid> beads;
  for (int i = 0; i < kBeads; ++i) {
    const double turn = 2 * std::numbers::pi * i / 17;  // 18 mm along the helix
    const Eigen::Vector3d centre(50 * std::cos(turn), 50 * std::sin(turn), 40 * turn / (2 * std::numbers::pi));
    beads.push_back(sim::sphere(centre, touching ? 13 : 8, static_cast<Label>(i + 1)));
  }
  return sim::SolidPhantom(std::move(beads));
}

std::vector<TrackedSlice> resampled(const std::vector<TrackedSlice>& slices, std::size_t points) {
  const double factor = static_cast<double>(points) / static_cast<double>(point_count(slices));
  std::vector<TrackedSlice> result;
  for (const TrackedSlice& slice : slices) {
    TrackedSlice& copy = result.emplace_back(slice);
    copy.points.clear();
    for (Contour& contour : copy.contours) {
      const auto loop = std::span(slice.points).subspan(contour.first, contour.count);
      const auto count = static_cast<std::uint32_t>(std::max(3.0, std::round(factor * contour.count)));
      contour.first = static_cast<std::uint32_t>(copy.points.size());
      contour.count = count;
      for (std::uint32_t i = 0; i < count; ++i)
        copy.points.push_back(on_curve(loop, static_cast<double>(i) * static_cast<double>(loop.size()) / count));
    }
  }
  return result;
}

std::vector<TrackedSlice> with_labels(std::vector<TrackedSlice> slices, int count) {
  for (TrackedSlice& slice : slices)
    for (Contour& contour : slice.contours)
      if (!contour.hole) contour.label = static_cast<Label>((contour.label - 1) % count + 1);
  return slices;
}

std::size_t point_count(const std::vector<TrackedSlice>& slices) {
  std::size_t count = 0;
  for (const TrackedSlice& slice : slices) count += slice.points.size();
  return count;
}

}  // namespace sonoloft::bench
