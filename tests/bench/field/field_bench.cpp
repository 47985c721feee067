// Edge evaluations per second and core of every field evaluator, on cells of few and of many edges.  bench_field
#include <array>
#include <ctime>
#include <utility>

#include "core/field/cpu/cpu_evaluator.h"
#include "core/gpu/make_evaluator.h"
#include "tests/bench/support/figures.h"
#include "tests/support/field/field_cells.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

constexpr double kSeconds = 0.5;  ///< a figure

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

/// The processor time of an evaluation, s, the median of many: the clock of a process with threads is now and then
/// behind, so the least is none.
double median_time(FieldEvaluator& evaluator, FieldBatch& batch) {
  std::vector<double> times;
  double total = 0;
  while (total < kSeconds) {
    const std::clock_t start = std::clock();
    if (const auto done = evaluator.evaluate(batch); !done) stop(done.error());
    const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    times.push_back(took);
    total += took;
  }
  return median(std::move(times));
}

void measure(const std::string& device, FieldEvaluator& evaluator) {
  for (const auto& [planes, ring_points] : {std::pair{4, 3}, {8, 3}, {8, 15}, {8, 60}, {8, 400}}) {
    FieldBatch batch;
    const Load load = fill(batch, planes, ring_points, 24);
    const double rate = load.evaluations / median_time(evaluator, batch);
    const double edges = load.evaluations / load.points;
    char words[200];
    std::snprintf(words, sizeof words, "%s: %.0f edges a cell, %.0f points: %.2f G edge evaluations/s/core",
                  evaluator.name().c_str(), edges, load.points, rate * 1e-9);
    emit({{"bench", "field"},
          {"device", device},
          {"name", evaluator.name()},
          {"edges_a_cell", edges},
          {"edge_evaluations_per_s_core", rate}},
         words);
  }
}

}  // namespace

int main() {
  if (const auto opencl = make_evaluator(DeviceChoice::opencl, 1, {}))
    measure("opencl", **opencl);
  else
    std::fprintf(stderr, "%s\n", opencl.error().message.c_str());
  for (const CpuKernel& kernel : usable_cpu_kernels()) measure("cpu", *make_cpu_evaluator(kernel, 1));
}
