#include "core/cells/face_polygon.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>
#include <random>

#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// A square of half-width 10, outside, with a disc of label 1 in it and a disc of label 2 beside it.
FacePolygon square_with_discs() {
  FacePolygon polygon;
  const Eigen::Vector2d corner[4] = {{-10, -10}, {10, -10}, {10, 10}, {-10, 10}};
  for (int i = 0; i < 4; ++i) polygon.push_back({corner[i], corner[(i + 1) % 4], kOutside, kBeyondFace});
  const Section discs = test::section_of_discs(Eigen::Isometry3d::Identity(), {{{-4, 0}, 3.0, 1}, {{5, 1}, 4.0, 2}});
  for (const SectionEdge& e : discs.edges) polygon.push_back({discs.points[e.a], discs.points[e.b], e.left, e.right});
  return polygon;
}

/// For every label the edges with it on one side form closed loops: as many start in a point as end there.
bool labels_are_closed(const FacePolygon& polygon) {
  std::map<Label, std::map<std::pair<double, double>, int>> balance;
  for (const FaceEdge& e : polygon) {
    for (const auto& [label, sign] : {std::pair{e.left, 1}, std::pair{e.right, -1}}) {
      balance[label][{e.a.x(), e.a.y()}] += sign;
      balance[label][{e.b.x(), e.b.y()}] -= sign;
    }
  }
  for (const auto& [label, points] : balance)
    for (const auto& [point, count] : points)
      if (count != 0) return false;
  return true;
}

}  // namespace

TEST_CASE("face polygon: splitting by 200 random lines loses no area of any label and leaves every label closed") {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-8.0, 8.0);
  for (int round = 0; round < 20; ++round) {
    std::vector<FacePolygon> pieces{square_with_discs()};
    const FacePolygon whole = pieces.front();
    for (int i = 0; i < 10; ++i) {
      const double angle = uniform(rng);
      const ImageLine line{{std::cos(angle), std::sin(angle)}, uniform(rng)};
      std::vector<FacePolygon> next;
      for (const FacePolygon& piece : pieces) {
        auto [below, above] = split(piece, line);
        if (!below.empty()) next.push_back(std::move(below));
        if (!above.empty()) next.push_back(std::move(above));
      }
      pieces = std::move(next);
    }
    for (const Label label : {kOutside, Label{1}, Label{2}, kBeyondFace}) {
      double sum = 0.0;
      for (const FacePolygon& piece : pieces) sum += area(piece, label);
      CHECK(sum == doctest::Approx(area(whole, label)).epsilon(1e-12));
    }
    for (const FacePolygon& piece : pieces) CHECK(labels_are_closed(piece));
  }
}

TEST_CASE("face polygon: a line through vertices, along edges and past the face splits like any other") {
  const FacePolygon whole = square_with_discs();
  SUBCASE("through two vertices of a disc") {
    const auto [below, above] = split(whole, {{0.0, 1.0}, 0.0});
    CHECK(labels_are_closed(below));
    CHECK(labels_are_closed(above));
    CHECK(area(below, 1) == doctest::Approx(area(whole, 1) / 2));
    CHECK(area(above, 1) == doctest::Approx(area(whole, 1) / 2));
  }
  SUBCASE("along a side of the square") {
    const auto [below, above] = split(whole, {{0.0, 1.0}, 10.0});
    CHECK(area(below) == doctest::Approx(0.0));
    CHECK(area(above) == doctest::Approx(400.0));
  }
  SUBCASE("past it") {
    const auto [below, above] = split(whole, {{1.0, 0.0}, 11.0});
    CHECK(below.empty());
    CHECK(above.size() == whole.size());
  }
}
