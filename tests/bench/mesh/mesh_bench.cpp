// The mesh stage on fields given by formulas: everything once, and a few bricks at a time.  bench_mesh
#include <ctime>

#include "core/mesh/surface_extractor.h"
#include "tests/bench/support/figures.h"
#include "tests/support/mesh/synthetic_lattice.h"

namespace sonoloft::bench {
namespace {

using namespace test;

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
    best.wall_ms = std::min(best.wall_ms, ms_since(start));
    best.cpu_ms = std::min(best.cpu_ms, cpu_ms);
  }
  return best;
}

void full(const std::string& name, const SyntheticLattice& lattice, SurfaceExtractor& extractor) {
  for (const int threads : {1, 2}) {
    const Times times = best_of([&] {
      extractor = SurfaceExtractor();
      extractor.update(lattice, lattice.bricks(), threads);
    });
    const auto counters = extractor.counters();
    const double per_leaf_ns = times.cpu_ms * 1e6 / static_cast<double>(counters.leaves);
    char words[200];
    std::snprintf(words, sizeof words,
                  "mesh of %s, %d thread(s): %zu leaves (%zu complex): %.1f ms, cpu %.0f ns a leaf", name.c_str(),
                  threads, counters.leaves, counters.complex_cells, times.wall_ms, per_leaf_ns);
    emit({{"bench", "mesh"},
          {"lattice", name},
          {"threads", threads},
          {"leaves", counters.leaves},
          {"complex_cells", counters.complex_cells},
          {"wall_ms", times.wall_ms},
          {"cpu_ms", times.cpu_ms}},
         words);
  }
}

void local(const std::string& name, const SyntheticLattice& lattice, SurfaceExtractor& extractor) {
  const std::vector<BrickCoord> all = lattice.bricks();
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  const std::vector<BrickCoord> few(middle, middle + std::min<std::ptrdiff_t>(8, all.end() - middle));
  const Times again = best_of([&] { extractor.update(lattice, few, 1); });
  const Times shot = best_of([&] { static_cast<void>(extractor.snapshot()); });
  const Times joined = best_of([&] { static_cast<void>(extractor.snapshot().indexed()); });
  char words[200];
  std::snprintf(words, sizeof words, "mesh of %s: 8 bricks again %.3f ms, snapshot %.3f ms, joined in %.1f ms",
                name.c_str(), again.cpu_ms, shot.cpu_ms, joined.cpu_ms);
  emit({{"bench", "mesh_local"},
        {"lattice", name},
        {"eight_bricks_cpu_ms", again.cpu_ms},
        {"snapshot_cpu_ms", shot.cpu_ms},
        {"joined_cpu_ms", joined.cpu_ms}},
       words);
}

void measure(const std::string& name, const SyntheticLattice& lattice) {
  SurfaceExtractor extractor;
  full(name, lattice, extractor);
  local(name, lattice, extractor);
}

}  // namespace
}  // namespace sonoloft::bench

int main() {
  using namespace sonoloft::bench;
  measure("sphere", SyntheticLattice(192, 2, sphere_field({96.3, 95.8, 96.1}, 90.7)));
  measure("four spheres", SyntheticLattice(128, 5,
                                           spheres_field({{{48.3, 51.1, 53.2}, 34.4},
                                                          {{79.7, 54.3, 57.9}, 31.2},
                                                          {{62.1, 80.6, 59.4}, 35.9},
                                                          {{64.2, 63.9, 85.7}, 32.7}})));
  measure("waves", SyntheticLattice(96, 5, waves_field(3)));
  measure("noise", SyntheticLattice(64, 5, noise_field(3, 1)));
}
