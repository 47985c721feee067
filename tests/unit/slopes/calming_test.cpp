#include "core/slopes/contour/calming.h"

#include <doctest/doctest.h>

#include <array>
#include <random>
#include <utility>

#include "core/slopes/contour/arc_shape.h"
#include "tests/support/planes.h"

namespace sonoloft {
namespace {

constexpr double kFeature = 1.7, kRadius = 30;

Section circle() {
  return test::section_of_discs(Eigen::Isometry3d::Identity(), {{{0, 0}, kRadius, 1}}, 200);
}

Section rough(Section section, double sigma) {
  std::mt19937 rng(1);
  std::normal_distribution<double> noise(0, sigma);
  for (Eigen::Vector2d& p : section.points) p += Eigen::Vector2d(noise(rng), noise(rng));
  return section;
}

/// Root mean square angle between the normals that are measured and those of the circle, radians.
double normals_off(const Section& section) {
  const Arcs arcs = arcs_of(section);
  const ArcShape shape = shape_of(section, arcs, kFeature);
  double sum = 0;
  for (std::size_t place = 0; place < arcs.point.size(); ++place) {
    const double cosine = section.points[arcs.point[place]].normalized().dot(shape.outward[place].cast<double>());
    sum += std::pow(std::acos(std::min(1.0, cosine)), 2);
  }
  return std::sqrt(sum / static_cast<double>(arcs.point.size()));
}

TEST_CASE("slopes: contours without noise stay as they are, corners too") {
  Section square;
  for (std::uint32_t side = 0; side < 4; ++side)
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d p(-10 + i, -10);
      square.points.emplace_back(Eigen::Rotation2Dd(side * std::numbers::pi / 2) * p);
    }
  for (std::uint32_t i = 0; i < 80; ++i) square.edges.push_back({i, (i + 1) % 80, 1, 0});
  CHECK(calmed(square, arcs_of(square), kFeature).points == square.points);
  CHECK(calmed(circle(), arcs_of(circle()), kFeature).points == circle().points);
}

TEST_CASE("slopes: a rough circle is calmed to nearer the circle, and no point moves farther than its noise explains") {
  for (const double sigma : {0.2, 0.4}) {
    const Section before = rough(circle(), sigma);
    const Section after = calmed(before, arcs_of(before), kFeature);
    double farthest = 0, off_before = 0, off_after = 0;
    for (std::size_t i = 0; i < before.points.size(); ++i) {
      farthest = std::max(farthest, (after.points[i] - before.points[i]).norm());
      off_before += std::pow(before.points[i].norm() - kRadius, 2);
      off_after += std::pow(after.points[i].norm() - kRadius, 2);
    }
    MESSAGE("noise ", sigma, ": off by ", std::sqrt(off_before / 200), " before and ", std::sqrt(off_after / 200),
            ", normals ", normals_off(before), " and ", normals_off(after), "; moved by up to ", farthest);
    CHECK(off_after < 0.5 * off_before);
    CHECK(normals_off(after) < 0.8 * normals_off(before));
    CHECK(farthest < 4 * sigma);
  }
}

TEST_CASE("slopes: calming keeps the ends of arcs and what borders on something unknown") {
  Section fan;
  fan.points = {{0, 0}};
  constexpr std::array<std::pair<Label, Label>, 3> sides = {{{1, kUnknown}, {2, 1}, {kUnknown, 2}}};
  for (std::uint32_t spoke = 0; spoke < 3; ++spoke) {
    const auto& [left, right] = sides[spoke];
    for (std::uint32_t i = 0; i < 40; ++i) {
      const double angle = spoke * 2 * std::numbers::pi / 3;
      const std::uint32_t last = static_cast<std::uint32_t>(fan.points.size()) - 1;
      fan.points.emplace_back(Eigen::Rotation2Dd(angle) * Eigen::Vector2d(1 + i, 0));
      fan.edges.push_back({i == 0 ? 0 : last, last + 1, left, right});
    }
  }
  fan = rough(std::move(fan), 0.2);
  const Section after = calmed(fan, arcs_of(fan), kFeature);
  for (const std::size_t end : {0u, 40u, 80u, 120u}) CHECK(after.points[end] == fan.points[end]);
  for (std::size_t i = 1; i <= 40; ++i) CHECK(after.points[i] == fan.points[i]);
  CHECK(after.points[60] != fan.points[60]);
}

}  // namespace
}  // namespace sonoloft
