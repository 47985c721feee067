// What one recorded set costs: all slices at once, slice by slice, and the memory for both. A process measures one set,
// so that no memory of another one counts.  bench_set <file.csl> <depth>
#include <array>
#include <chrono>
#include <optional>

#include "tests/bench/support/reconstruction.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

constexpr std::size_t kRuns = 5;
constexpr int kThreads = 2;
constexpr std::size_t kOnlineSlices = 15;  ///< fewer are no scan
constexpr std::chrono::milliseconds kBetweenSlices(33);

nlohmann::json batches(std::span<const TrackedSlice> slices, ReconstructorOptions options, nlohmann::json& figures) {
  nlohmann::json runs;
  for (options.threads = 1; options.threads <= kThreads; ++options.threads) {
    const Batch batch = median_batch(slices, options, kRuns);
    runs.push_back(batch.times);
    runs.back()["threads"] = options.threads;
    figures["counts"] = batch.counts;
    figures["edge_evaluations"] = batch.edge_evaluations;
  }
  return runs;
}

nlohmann::json online(std::span<const TrackedSlice> slices, ReconstructorOptions options,
                      std::optional<Clock::duration> between = {}) {
  if (slices.size() < kOnlineSlices) return nullptr;
  options.threads = kThreads;
  const std::vector<SliceCost> costs = run_online(slices, options, between);
  const std::size_t first_of_last = costs.size() * 2 / 3;
  std::vector<double> all, last;
  std::array<int, kDetails> drawn{};
  for (std::size_t i = 0; i < costs.size(); ++i) {
    all.push_back(costs[i].ms);
    if (i < first_of_last) continue;
    last.push_back(costs[i].ms);
    ++drawn[static_cast<std::size_t>(costs[i].detail)];
  }
  return {{"threads", kThreads},
          {"slices", costs},
          {"last_third_drawn", drawn},
          {"p50_ms", quantile(all, 0.5)},
          {"p95_ms", quantile(all, 0.95)},
          {"last_third_p50_ms", quantile(last, 0.5)},
          {"last_third_p95_ms", quantile(last, 0.95)}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_set <file.csl> <depth>\n");
    return 2;
  }
  const std::filesystem::path file = argv[1];
  const int depth = std::atoi(argv[2]);
  const std::vector<TrackedSlice> slices = read_set(file);
  const ReconstructorOptions options = or_exit(options_for(slices, depth));

  nlohmann::json figures{{"bench", "set"}, {"set", file.stem().string()}, {"depth", depth}, {"slices", slices.size()}};
  figures["runs"] = batches(slices, options, figures);
  figures["online"] = online(slices, options);
  figures["online_live"] = online(slices, options, kBetweenSlices);
  figures["peak_memory_mib"] = peak_memory_mib();
  char words[200];
  std::snprintf(words, sizeof words, "set %s, depth %d: %.1f ms with %d threads", file.stem().c_str(), depth,
                figures["runs"].back()["total_ms"].get<double>(), kThreads);
  emit(figures, words);
}
