#include "core/slopes/contour/arcs.h"

#include <doctest/doctest.h>

#include "core/slopes/contour/arc_shape.h"
#include "tests/support/planes.h"

namespace sonoloft {
namespace {

/// A square of label 1 beside one of label 2, with a common side; around them outside.
Section two_squares() {
  Section section;
  section.points = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}};
  section.edges = {{0, 1, 1, 0}, {1, 2, 2, 0}, {2, 3, 2, 0}, {4, 3, 0, 2}, {4, 5, 1, 0}, {0, 5, 0, 1}, {1, 4, 1, 2}};
  return section;
}

TEST_CASE("slopes: an arc goes from junction to junction with the greater label on its left") {
  const Section section = two_squares();
  const Arcs arcs = arcs_of(section);
  REQUIRE(arcs.arcs.size() == 3);
  for (const Arc& arc : arcs.arcs) {
    CHECK_FALSE(arc.closed);
    CHECK(arc.left > arc.right);
    CHECK(arc.length_mm == doctest::Approx(arc.left == 2 && arc.right == 1 ? 1 : 3));
    for (const std::uint32_t end : {arc.first, arc.end() - 1}) CHECK((arcs.point[end] == 1 || arcs.point[end] == 4));
  }
  for (std::uint32_t e = 0; e < section.edges.size(); ++e) {
    const std::uint32_t place = arcs.place_of_edge[e], next = arcs.arc_at(place).next(place);
    const bool turned = section.edges[e].left < section.edges[e].right;
    CHECK(arcs.point[place] == (turned ? section.edges[e].b : section.edges[e].a));
    CHECK(arcs.point[next] == (turned ? section.edges[e].a : section.edges[e].b));
  }
}

TEST_CASE("slopes: a closed contour is one arc of all its edges") {
  const Section disc = test::section_of_discs(Eigen::Isometry3d::Identity(), {{{1, 2}, 10, 5}, {{40, 2}, 3, 4}}, 30);
  const Arcs arcs = arcs_of(disc);
  REQUIRE(arcs.arcs.size() == 2);
  CHECK(arcs.arcs[0].closed);
  CHECK(arcs.arcs[0].count == 30);
  CHECK(arcs.arcs[0].left == 5);
  CHECK(arcs.arcs[0].length_mm == doctest::Approx(2 * 30 * 10 * std::sin(std::numbers::pi / 30)));
}

TEST_CASE("slopes: an arc goes straight on where a border crosses itself, and ends where four labels meet") {
  Section bow;
  bow.points = {{0, 0}, {10, -5}, {10, 5}, {-10, 5}, {-10, -5}};
  bow.edges = {{0, 1, 1, 0}, {1, 2, 1, 0}, {2, 0, 1, 0}, {0, 3, 1, 0}, {3, 4, 1, 0}, {0, 4, 0, 1}};
  const Arcs arcs = arcs_of(bow);
  REQUIRE(arcs.arcs.size() == 1);
  CHECK(arcs.arcs[0].closed);
  CHECK(arcs.point == std::vector<std::uint32_t>{0, 1, 2, 0, 3, 4});
  for (std::uint32_t e = 0; e < bow.edges.size(); ++e) CHECK(arcs.place_of_edge[e] == e);

  Section cross;
  cross.points = {{0, 0}, {5, 0}, {0, 5}, {-5, 0}, {0, -5}};
  cross.edges = {{0, 1, 1, 4}, {0, 2, 2, 1}, {0, 3, 3, 2}, {0, 4, 4, 3}};
  CHECK(arcs_of(cross).arcs.size() == 4);
}

TEST_CASE("slopes: a circle has its curvature and normals, large or small, and a hole the opposite") {
  const Section section =
      test::section_of_discs(Eigen::Isometry3d::Identity(), {{{0, 0}, 30, 1}, {{100, 0}, 2, 1}}, 200);
  const Arcs arcs = arcs_of(section);
  const ArcShape shape = shape_of(section, arcs, 1.7);
  double worst_turn = 0, worst_curvature = 0;
  for (std::size_t place = 0; place < arcs.point.size(); ++place) {
    const Eigen::Vector2d& p = section.points[arcs.point[place]];
    const Eigen::Vector2d radius = p.x() < 50 ? p : Eigen::Vector2d(p - Eigen::Vector2d(100, 0));
    worst_turn = std::max(worst_turn, (radius.normalized() - shape.outward[place].cast<double>()).norm());
    worst_curvature = std::max(worst_curvature, std::abs(shape.curvature_per_mm[place] * radius.norm() - 1));
  }
  MESSAGE("normal off by ", worst_turn, ", curvature by ", worst_curvature, " of itself");
  CHECK(worst_turn < 1e-3);
  CHECK(worst_curvature < 2e-3);

  Section hole = section;
  for (SectionEdge& e : hole.edges) std::swap(e.left, e.right);
  const ArcShape turned = shape_of(hole, arcs_of(hole), 1.7);
  for (const float curvature : turned.curvature_per_mm) CHECK(curvature < 0);
}

TEST_CASE("slopes: towards the ends of an open arc normals and curvature stay those of the circle") {
  Section section;  // a half disc of label 1, its straight side towards something unknown
  constexpr std::uint32_t kSides = 200;
  for (std::uint32_t i = 0; i <= kSides; ++i) {
    const double angle = std::numbers::pi * i / kSides;
    section.points.emplace_back(30 * std::cos(angle), 30 * std::sin(angle));
    if (i > 0) section.edges.push_back({i - 1, i, 1, 0});
  }
  section.points.emplace_back(60, 0);
  section.points.emplace_back(-60, 0);
  section.points.emplace_back(0, 60);
  section.edges.insert(section.edges.end(), {{kSides, 0, 1, kUnknown},
                                             {0, kSides + 1, 0, kUnknown},
                                             {kSides + 1, kSides + 3, 0, kUnknown},
                                             {kSides + 3, kSides + 2, 0, kUnknown},
                                             {kSides + 2, kSides, 0, kUnknown}});
  const Arcs arcs = arcs_of(section);
  const ArcShape shape = shape_of(section, arcs, 1.7);
  for (std::size_t place = 0; place < arcs.point.size(); ++place) {
    if (!arcs.arc_at(static_cast<std::uint32_t>(place)).is_surface()) {
      CHECK(shape.curvature_per_mm[place] == 0);
      continue;
    }
    CHECK(shape.curvature_per_mm[place] * 30 == doctest::Approx(1).epsilon(5e-3));
    CHECK((shape.outward[place].cast<double>() - section.points[arcs.point[place]] / 30).norm() < 2e-3);
  }
}

}  // namespace
}  // namespace sonoloft
