// Edge evaluations per second and core of every field evaluator: bench_field [seconds per figure]
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <utility>

#include "core/gpu/make_evaluator.h"
#include "tests/support/field_cells.h"

namespace {

using namespace sonoloft;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Points of a lattice in the cell, row by row, as the sampling stage asks for them.
std::vector<Eigen::Vector3d> lattice_points(const test::FieldCell& cell, int steps) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < steps * steps * steps; ++i) {
    const Eigen::Vector3d index(i % steps, i / steps % steps, i / (steps * steps));
    const Eigen::Vector3d p = cell.centre() + cell.size_mm() * ((index.array() + 0.5) / steps - 0.5).matrix();
    if (cell.depth(p) > 0) points.push_back(p);
  }
  return points;
}

struct Load {
  double points = 0, evaluations = 0;  ///< evaluations: edges times points
};

/// 64 random cells of at most `planes` faces, `steps`^3 lattice points over every one.
Load fill(FieldBatch& batch, int planes, int ring_points, int steps) {
  test::Random random(7);
  const std::array<Label, 2> labels = {0, 1};
  Load load;
  for (int i = 0; i < 64; ++i) {
    const test::FieldCell cell(test::random_walls(random, planes, labels, ring_points, 30.0));
    const std::uint32_t index = batch.cells.add(cell.faces(), cell.centre());
    if (batch.cells.constant(index)) continue;
    const std::vector<Eigen::Vector3d> points = lattice_points(cell, steps);
    batch.add_points(index, points);
    load.points += static_cast<double>(points.size());
    load.evaluations += static_cast<double>(points.size()) * batch.cells.edge_count(index);
  }
  return load;
}

/// Counts processor seconds, not seconds: other programs may be running.
void measure(FieldEvaluator& evaluator, double seconds) {
  std::printf("%s\n", evaluator.name().c_str());
  for (const auto& [planes, ring_points] : {std::pair{4, 3}, {8, 3}, {8, 15}, {8, 80}, {8, 400}}) {
    FieldBatch batch;
    const Load load = fill(batch, planes, ring_points, 24);
    if (const auto done = evaluator.evaluate(batch); !done) {
      std::printf("  %s\n", done.error().message.c_str());
      return;
    }
    double best = 1e30, total = 0;
    while (total < seconds) {
      const std::clock_t start = std::clock();
      if (!evaluator.evaluate(batch)) return;
      const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      best = std::min(best, took);
      total += took;
    }
    std::printf("  %6.0f edges a cell, %7.0f points: %6.0f M edge evaluations/s/core\n", load.evaluations / load.points,
                load.points, load.evaluations / best * 1e-6);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 1.0;
  const auto print = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
  for (const DeviceChoice choice : {DeviceChoice::opencl, DeviceChoice::cpu}) {
    const auto start = Clock::now();
    const auto evaluator = make_evaluator(choice, 1, print);
    if (!evaluator) {
      std::printf("%s\n", evaluator.error().message.c_str());
      continue;
    }
    std::printf("made in %.3f s\n", seconds_since(start));
    measure(**evaluator, seconds);
  }
}
