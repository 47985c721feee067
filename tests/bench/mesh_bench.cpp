// Prints how long the mesh stage takes: everything once, and a few bricks at a time.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>

#include "core/mesh/surface_extractor.h"
#include "tests/support/synthetic_lattice.h"

namespace sonoloft::test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kRuns = 9;

struct Times {
  double wall_ms = 1e9;
  double cpu_ms = 1e9;  ///< of all threads: what is left of a measurement on a busy machine
};

/// The best of kRuns.
template <class Body>
Times best_of(const Body& body) {
  Times best;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = Clock::now();
    const std::clock_t cpu_start = std::clock();
    body();
    const double cpu_ms = 1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    best.wall_ms = std::min(best.wall_ms, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    best.cpu_ms = std::min(best.cpu_ms, cpu_ms);
  }
  return best;
}

void measure(const std::string& name, const SyntheticLattice& lattice) {
  const std::vector<BrickCoord> all = lattice.bricks();
  SurfaceExtractor extractor;
  for (const int threads : {1, 2}) {
    const Times full = best_of([&] {
      extractor = SurfaceExtractor();
      extractor.update(lattice, all, threads);
    });
    const auto counters = extractor.counters();
    std::printf(
        "%-13s %d thread(s): %zu leaves (%zu complex) in %zu bricks: %.1f ms, cpu %.1f ms, %.1f per 100k leaves\n",
        name.c_str(), threads, counters.leaves, counters.complex_cells, all.size(), full.wall_ms, full.cpu_ms,
        full.cpu_ms * 1e5 / static_cast<double>(counters.leaves));
  }
  MeshSnapshot snapshot;
  const Times shot = best_of([&] { snapshot = extractor.snapshot(); });
  IndexedMesh mesh;
  const Times joined = best_of([&] { mesh = snapshot.indexed(); });
  const std::vector<BrickCoord> few(all.begin() + static_cast<long>(all.size() / 2),
                                    all.begin() + static_cast<long>(std::min(all.size(), all.size() / 2 + 8)));
  const Times local = best_of([&] { extractor.update(lattice, few, 1); });
  std::printf(
      "%-13s snapshot %.3f ms; %zu vertices, %zu triangles joined in %.1f ms; 8 bricks again %.3f ms (%zu read)\n",
      name.c_str(), shot.cpu_ms, mesh.positions.size(), mesh.triangles.size(), joined.cpu_ms, local.cpu_ms,
      extractor.counters().bricks_read);
}

}  // namespace
}  // namespace sonoloft::test

int main() {
  using namespace sonoloft::test;
  measure("sphere", SyntheticLattice(192, 2, sphere_field({96.3, 95.8, 96.1}, 90.7)));
  measure("four spheres", SyntheticLattice(128, 5,
                                           spheres_field({{{48.3, 51.1, 53.2}, 34.4},
                                                          {{79.7, 54.3, 57.9}, 31.2},
                                                          {{62.1, 80.6, 59.4}, 35.9},
                                                          {{64.2, 63.9, 85.7}, 32.7}})));
  measure("waves", SyntheticLattice(96, 5, waves_field(3)));
  measure("noise", SyntheticLattice(64, 5, noise_field(3, 1)));
  return 0;
}
