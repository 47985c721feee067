#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "core/field/cpu/cpu_evaluator.h"
#include "core/field/reference.h"
#include "tests/support/field/field_batches.h"
#include "tests/support/field/field_cells.h"

using namespace sonoloft;
using test::FieldCell;

namespace {

const std::array<Label, 6> kFiveLabels = {0, 1, 2, 3, 900, kUnknown};

std::vector<Eigen::Vector3d> random_points(const FieldCell& cell, test::Random& random, int count) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back(cell.random_point(random));
  return points;
}

/// The share of `label` in a block's point; 0 when the cell does not have it.
double share_of(const FieldBatch& batch, std::uint32_t block, std::size_t point, Label label) {
  const std::span<const Label> labels = batch.cells.labels(batch.blocks[block].cell);
  const auto slot = std::find(labels.begin(), labels.end(), label) - labels.begin();
  return slot == std::ssize(labels) ? 0 : batch.row(block, static_cast<std::uint32_t>(slot))[point];
}

}  // namespace

TEST_CASE("field: the shares of all labels sum to 1 everywhere, walls, borders and corners among them") {
  test::Random random(11);
  double worst = 0, lowest = 0, highest = 1;
  for (int round = 0; round < 40; ++round) {
    const FieldCell cell(test::random_walls(random, 4 + round % 15, kFiveLabels, 8, 20.0));
    std::vector<Eigen::Vector3d> points = random_points(cell, random, 50);
    for (const test::Wall& wall : cell.walls())
      for (const FaceEdge& e : wall.polygon) {
        points.push_back(wall.frame * Eigen::Vector3d(e.a.x(), e.a.y(), 0));
        points.push_back(wall.frame * Eigen::Vector3d(0.5 * (e.a + e.b).x(), 0.5 * (e.a + e.b).y(), 0));
      }
    FieldBatch batch;
    const std::uint32_t block = batch.add_points(batch.cells.add(cell.faces(), cell.centre()), points);
    REQUIRE(make_cpu_evaluator(1)->evaluate(batch));
    for (std::size_t i = 0; i < points.size(); ++i) {
      double sum = 0;
      for (const Label label : batch.cells.labels(0)) {
        const double share = share_of(batch, block, i, label);
        lowest = std::min(lowest, share);
        highest = std::max(highest, share);
        sum += share;
      }
      worst = std::max(worst, std::abs(sum - 1));
    }
  }
  MESSAGE("largest difference of a sum from 1: " << worst << "; shares from " << lowest << " to " << highest);
  CHECK(worst < 1e-5);
  CHECK(lowest > -1e-4);
  CHECK(highest < 1 + 1e-4);
}

TEST_CASE("field: a share has the same bits whatever is evaluated beside it and by how many threads") {
  test::Random random(12);
  test::ShuffledBatches batches(random, kFiveLabels);
  for (const CpuKernel& kernel : usable_cpu_kernels()) {
    REQUIRE(make_cpu_evaluator(kernel, 1)->evaluate(batches.straight));
    for (const int threads : {1, 3}) {
      REQUIRE(make_cpu_evaluator(kernel, threads)->evaluate(batches.shuffled));
      CHECK(batches.different_bits() == 0);
    }
  }
}

TEST_CASE("field: AVX2 and AVX-512 give the same bits") {
  test::Random random(13);
  test::ShuffledBatches batches(random, kFiveLabels);
  const std::vector<CpuKernel> kernels = usable_cpu_kernels();
  if (kernels.size() < 3) {
    MESSAGE("SKIPPED: this machine has no AVX-512");
    return;
  }
  REQUIRE(make_cpu_evaluator(kernels[0], 1)->evaluate(batches.straight));
  REQUIRE(make_cpu_evaluator(kernels[1], 1)->evaluate(batches.shuffled));
  CHECK(batches.different_bits() == 0);
}

TEST_CASE("field: the two sides of a wall meet in the wall's label, and in each other near its borders") {
  test::Random random(14);
  double worst_gap = 0, worst_label = 0;
  int points = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<test::Wall> walls = test::random_walls(random, 4 + round % 10, kFiveLabels, 8, 20.0);
    walls.push_back(test::random_wall(random, test::uniform_direction(random), test::uniform(random, -2, 2),
                                      test::random_rings(random, kFiveLabels, 8, 20.0)));
    const Eigen::Isometry3d frame = walls.back().frame;
    const double size = 20.0, off = 1e-5 * size;
    std::array<FieldBatch, 2> sides;
    std::vector<Eigen::Vector2d> on_wall;
    FacePolygon polygon;
    for (std::size_t side = 0; side < 2; ++side) {
      walls.back().above = side == 1;
      const FieldCell cell(walls);
      if (side == 0) {
        polygon = cell.walls().back().polygon;
        for (int i = 0; i < 60; ++i) {
          const FaceEdge& e = polygon[random() % polygon.size()];
          const FaceEdge& f = polygon[random() % polygon.size()];
          on_wall.push_back(e.a + test::uniform(random, 0.1, 0.9) * (f.a - e.a));
        }
      }
      std::vector<Eigen::Vector3d> inside;
      for (const Eigen::Vector2d& p : on_wall)
        inside.push_back(frame * Eigen::Vector3d(p.x(), p.y(), side == 1 ? off : -off));
      sides[side].add_points(sides[side].cells.add(cell.faces(), cell.centre()), inside);
      REQUIRE(make_cpu_evaluator(1)->evaluate(sides[side]));
    }
    for (std::size_t i = 0; i < on_wall.size(); ++i) {
      const auto [label, distance] = test::label_and_border_distance(polygon, on_wall[i]);
      if (distance < 0.01 * size) continue;
      ++points;
      for (const Label l : kFiveLabels) {
        const double below = share_of(sides[0], 0, i, l), above = share_of(sides[1], 0, i, l);
        worst_gap = std::max(worst_gap, std::abs(below - above));
        const double expected = l == label ? 1 : 0;
        worst_label = std::max({worst_label, std::abs(below - expected), std::abs(above - expected)});
      }
    }
  }
  MESSAGE(points << " points of walls, 1e-5 of the cell's size off: the sides differ by " << worst_gap
                 << ", from the wall's label by " << worst_label);
  CHECK(points > 200);
  CHECK(worst_gap < 2e-3);
  CHECK(worst_label < 2e-3);
}

TEST_CASE("field: on a border between two labels each has a half") {
  test::Random random(15);
  const std::array<Label, 3> labels = {0, 4, 9};
  double worst = 0;
  int borders = 0;
  for (int round = 0; round < 20; ++round) {
    const FieldCell cell(test::random_walls(random, 8, labels, 5, 20.0));
    FieldBatch batch;
    const std::uint32_t index = batch.cells.add(cell.faces(), cell.centre());
    for (const test::Wall& wall : cell.walls()) {
      for (const FaceEdge& e : wall.polygon) {
        if (e.right == kBeyondFace || (e.b - e.a).norm() < 1.0) continue;
        const Eigen::Vector2d middle = 0.5 * (e.a + e.b);
        const double off_mm = wall.above ? 1e-3 : -1e-3;
        const Eigen::Vector3d point = wall.frame * Eigen::Vector3d(middle.x(), middle.y(), off_mm);
        if (cell.depth(point) < 0.9e-3) continue;  // another wall is nearer
        batch.add_points(index, {&point, 1});
        REQUIRE(make_cpu_evaluator(1)->evaluate(batch));
        const auto block = static_cast<std::uint32_t>(batch.blocks.size() - 1);
        worst = std::max({worst, std::abs(share_of(batch, block, 0, e.left) - 0.5),
                          std::abs(share_of(batch, block, 0, e.right) - 0.5)});
        ++borders;
      }
    }
  }
  MESSAGE(borders << " borders, 0.001 mm off: shares differ from a half by " << worst);
  CHECK(borders > 100);
  CHECK(worst < 0.02);
}
