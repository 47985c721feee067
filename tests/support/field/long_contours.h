#pragma once
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/field/field_evaluator.h"
#include "core/field/reference.h"
#include "tests/support/field/field_cells.h"

/// Contours of so many edges that two stand for a far stretch of them.
namespace sonoloft::test {

/// r(angle) = 1 + 0.2 sin(3 angle), as seen at a height: it moves by its curvature and by a slope that varies along it.
inline Wall wavy_wall(const Eigen::Vector3d& outward, double distance_mm, int points, double scale_mm) {
  Wall wall{Eigen::Isometry3d::Identity(), false, {}, {}, {}};
  wall.frame.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), outward).toRotationMatrix();
  wall.frame.translation() = distance_mm * outward;
  const double far = 9 * scale_mm;
  add_loop(wall.polygon, {{-far, -far}, {far, -far}, {far, far}, {-far, far}}, 0, kBeyondFace);
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    const double r = 1 + 0.2 * std::sin(3 * angle), r1 = 0.6 * std::cos(3 * angle), r2 = 9 * (1 - r);
    const double length = std::hypot(r, r1);
    const Eigen::Vector2d radial(std::cos(angle), std::sin(angle)), across(-radial.y(), radial.x());
    wall.section.points.push_back(scale_mm * r * radial);
    const double curvature = (r * r + 2 * r1 * r1 - r * r2) / std::pow(length, 3) / scale_mm;
    wall.bends.push_back({((r * radial - r1 * across) / length).cast<float>(),
                          static_cast<float>(0.5 * std::sin(2 * angle)), static_cast<float>(curvature),
                          static_cast<float>(std::abs(curvature))});
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(points); ++i) {
    const std::uint32_t next = (i + 1) % static_cast<std::uint32_t>(points);
    wall.polygon.push_back({wall.section.points[i], wall.section.points[next], 1, 0, i});
    wall.section.edges.push_back({i, next, 1, 0});
  }
  return wall;
}

/// 6 x 6 x 0.4 mm, a contour of some 2 mm on both large walls.
inline FieldCell wavy_cell(int points) {
  std::vector<Wall> walls;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector3d outward = side * Eigen::Vector3d::Unit(axis);
      walls.push_back(wavy_wall(outward, axis == 2 ? 0.2 : 3, axis == 2 ? points : 0, 1));
    }
  return FieldCell(walls);
}

/// Holds shares among a contour of 1,500 edges to their double values: to `mean` on average and `most` anywhere.
inline void check_long_contours(FieldEvaluator& evaluator, double mean, double most) {
  const FieldCell cell = wavy_cell(1500);
  FieldBatch batch;
  const std::uint32_t index = batch.cells.add(cell.faces(), cell.centre(), {}, cell.bends());
  REQUIRE(batch.cells.stretches().size() > 400);
  Random random(5);
  std::vector<Eigen::Vector3d> points(1000);
  for (Eigen::Vector3d& p : points) p = cell.random_point(random);
  const std::uint32_t block = batch.add_points(index, points);
  REQUIRE(evaluator.evaluate(batch));
  double sum = 0, worst = 0;
  int mixed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double exact = reference_shares(cell.faces(), points[i], 1e-9, cell.bends()).share(1);
    const double error = std::abs(batch.row(block, 1)[i] - exact);
    sum += error, worst = std::max(worst, error);
    mixed += exact > 0.05 && exact < 0.95 ? 1 : 0;
  }
  MESSAGE(evaluator.name() << ": " << mixed << " points of 1000 between the labels, share error "
                           << sum / static_cast<double>(points.size()) << " on average, at most " << worst);
  CHECK(mixed > 50);
  CHECK(sum / static_cast<double>(points.size()) < mean);
  CHECK(worst < most);
}

}  // namespace sonoloft::test
