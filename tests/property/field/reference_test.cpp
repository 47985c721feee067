#include "core/field/reference.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "tests/support/field/field_cells.h"
#include "tests/support/field/region_quadrature.h"

using namespace sonoloft;

namespace {

double label_integral(const test::FieldCell& cell, const Eigen::Vector3d& point, Label label) {
  const auto everywhere = [](const Eigen::Vector2d&) { return 1.0; };
  double sum = 0;
  for (const test::Wall& wall : cell.walls()) {
    const Eigen::Vector3d p = wall.frame.inverse() * point;
    for (const FaceEdge& edge : wall.polygon) {
      if (edge.left != label && edge.right != label) continue;
      const double integral = test::triangle_integral(edge.a, edge.b, p.head<2>(), std::abs(p.z()), everywhere);
      sum += edge.left == label ? integral : -integral;
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("field: the double reference is the integral over the labelled regions to 1e-8 of the whole") {
  const std::array<Label, 4> labels = {0, 1, 5, kUnknown};
  test::Random random(3);
  double worst = 0, lowest = 1e300, highest = 0;
  for (int round = 0; round < 60; ++round) {
    const double scale_mm = std::pow(10.0, test::uniform(random, 0, 2.3));
    const test::FieldCell cell(test::random_walls(random, 4 + round % 15, labels, 7, scale_mm));
    Eigen::Vector3d point = cell.random_point(random);
    if (round % 3 == 0) {  // 0.001 mm above the middle of a wall's edge
      const test::Wall& wall = cell.walls()[0];
      const Eigen::Vector2d on_wall = 0.5 * (wall.polygon[0].a + wall.polygon[1].b);
      point = wall.frame * Eigen::Vector3d(on_wall.x(), on_wall.y(), wall.above ? 1e-3 : -1e-3);
    }
    lowest = std::min(lowest, cell.depth(point));
    highest = std::max(highest, cell.depth(point));
    const ReferenceShares reference = reference_shares(cell.faces(), point, 1e-12);
    for (const auto& [label, share] : reference.shares) {
      const double error = std::abs(label_integral(cell, point, label) / reference.total_per_mm - share);
      worst = std::max(worst, error);
      CHECK(error < 1e-8);
    }
  }
  MESSAGE("largest difference of a share from quadrature: " << worst << "; depths from " << lowest << " to " << highest
                                                            << " mm");
  CHECK(lowest < 2e-3);
  CHECK(highest > 10);
}

TEST_CASE("field: the reference's total is that of a sphere's view: pi over h above a wall that fills the sky") {
  // A slab of two wide walls: from between them each looks infinite, and the integral over a plane is pi / h.
  const std::array<Label, 1> labels = {0};
  test::Random random(5);
  std::vector<test::Wall> walls;
  for (const int side : {-1, 1})
    walls.push_back(
        test::random_wall(random, side * Eigen::Vector3d::UnitZ(), 1.0, test::random_rings(random, labels, 4, 1000)));
  for (const auto& outward :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0)})
    walls.push_back(test::random_wall(random, outward, 4000.0, test::random_rings(random, labels, 4, 1000)));
  const test::FieldCell cell(walls);
  const ReferenceShares reference = reference_shares(cell.faces(), {0, 0, 0.5}, 1e-12);
  CHECK(reference.total_per_mm == doctest::Approx(std::numbers::pi * (1 / 0.5 + 1 / 1.5)).epsilon(1e-6));
}
