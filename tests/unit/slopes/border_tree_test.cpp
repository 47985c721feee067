#include "core/slopes/contour/border_tree.h"

#include <doctest/doctest.h>

#include <limits>
#include <random>
#include <set>

#include "tests/support/planes.h"

namespace sonoloft {
namespace {

double distance(const Section& section, const SectionEdge& e, const Eigen::Vector2d& p) {
  const Eigen::Vector2d a = section.points[e.a], along = section.points[e.b] - a;
  return (p - a - std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along).norm();
}

/// By going round: no two discs overlap.
Label label_of(const Section& section, const Eigen::Vector2d& p) {
  Label label = kOutside;
  for (const SectionEdge& e : section.edges) {
    const Eigen::Vector2d &a = section.points[e.a], &b = section.points[e.b];
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    if (a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) > p.x())
      label = static_cast<Label>(label ^ e.left);  // out of it again at the second
  }
  return label;
}

Section discs() {
  return test::section_of_discs(Eigen::Isometry3d::Identity(),
                                {{{0, 0}, 10, 1}, {{25, 3}, 8, 2}, {{-4, 30}, 12, 34}, {{500, 0}, 1, 3}}, 37);
}

TEST_CASE("slopes: the nearest border is that of a search through all, with the label asked for, whatever the hint") {
  const Section section = discs();
  const BorderTree tree(section, arcs_of(section));
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-60, 60);
  std::uint32_t hint = 0;
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector2d p(uniform(rng), uniform(rng));
    for (const std::optional<Label> label :
         {std::optional<Label>{}, std::optional<Label>{34}, std::optional<Label>{2}}) {
      double expected = std::numeric_limits<double>::infinity();
      for (const SectionEdge& e : section.edges)
        if (!label || e.left == *label || e.right == *label) expected = std::min(expected, distance(section, e, p));
      const double reach = 20;
      const auto found = tree.nearest(p, reach, label, hint);
      REQUIRE((found.has_value() || expected > reach - 1e-3));
      if (!found) continue;
      hint = found->block;
      worst = std::max(worst, std::abs(found->distance_mm - expected));
      if (expected > 1e-3 && !label) CHECK(found->label == label_of(section, p));
    }
  }
  MESSAGE("distances off by ", worst, " mm");
  CHECK(worst < 1e-4);
}

TEST_CASE("slopes: a point beyond a sharp corner lies on the side that the corner points away from") {
  Section spike;  // seen from the tip, one of its sides has the point on its other side
  spike.points = {{0, 0}, {10, 0.5}, {-40, 6}};
  spike.edges = {{0, 1, 1, 0}, {1, 2, 1, 0}, {2, 0, 1, 0}};
  const BorderTree tree(spike, arcs_of(spike));
  for (double y = -3; y <= 3; y += 0.1) {
    const auto found = tree.nearest({13, y}, 10, std::nullopt, 0);
    REQUIRE(found);
    CHECK(found->label == kOutside);
  }
}

TEST_CASE("slopes: all edges that meet a line are among those visited, few others") {
  const Section section = discs();
  const Arcs arcs = arcs_of(section);
  const BorderTree tree(section, arcs);
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::size_t visited = 0, met = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d normal = Eigen::Vector2d(uniform(rng), uniform(rng)).normalized();
    const double offset = 30 * uniform(rng);
    std::set<std::uint32_t> places;
    tree.visit_near_line(normal, offset, [&](std::uint32_t place) { CHECK(places.insert(place).second); });
    visited += places.size();
    for (std::size_t e = 0; e < section.edges.size(); ++e) {
      const double a = normal.dot(section.points[section.edges[e].a]) + offset;
      const double b = normal.dot(section.points[section.edges[e].b]) + offset;
      if ((a < 0) == (b < 0)) continue;
      ++met;
      CHECK(places.contains(arcs.place_of_edge[e]));
    }
  }
  MESSAGE(visited, " visited, ", met, " met");
  CHECK(visited < 20 * met);
}

}  // namespace
}  // namespace sonoloft
