// Times the reconstruction of the recorded sets, stage by stage, and what each inserted slice costs.
// Usage: bench_reconstructor [folder of the sets, default ../shared/data]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "core/io/slice_files.h"
#include "core/reconstructor/reconstructor.h"

using namespace sonoloft;

namespace {

using Clock = std::chrono::steady_clock;
constexpr int kRuns = 5;
constexpr const char* kSets[] = {"Vetebrae", "Abdomen", "Heart-25-even-better", "Horsers",    "eight_20",
                                 "eight_15", "hand_ok", "ParallelEight",        "SideBishop", "rose"};

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

struct Times {
  double total = 0, cells = 0;
  UpdateReport stages;
};

Reconstructor make(const std::vector<TrackedSlice>& slices, int depth, int threads) {
  auto options = options_for(slices, depth);
  options->threads = threads;
  auto reconstructor = Reconstructor::create(*options);
  if (!reconstructor) {
    std::fprintf(stderr, "%s\n", reconstructor.error().message.c_str());
    std::exit(1);
  }
  return std::move(*reconstructor);
}

Times batch(const std::vector<TrackedSlice>& slices, int depth, int threads, ReconstructorCounts& counts) {
  Reconstructor reconstructor = make(slices, depth, threads);
  Times times;
  const auto start = Clock::now();
  for (const TrackedSlice& slice : slices)
    if (const auto report = reconstructor.add(slice)) times.cells += report->cells_ms;
  times.stages = *reconstructor.update();
  times.total = ms_since(start);
  counts = reconstructor.counts();
  return times;
}

void print_batch(const std::string& name, const std::vector<TrackedSlice>& slices, int depth, int threads) {
  std::vector<Times> runs(kRuns);
  ReconstructorCounts counts;
  for (Times& run : runs) run = batch(slices, depth, threads, counts);
  const auto median = [&](auto member) {
    std::vector<double> values;
    for (const Times& run : runs) values.push_back(member(run));
    return quantile(values, 0.5);
  };
  std::printf("%-22s %d %d %8.1f %7.1f %7.1f %7.1f %7.1f %7.1f %8zu %8zu %8zu\n", name.c_str(), depth, threads,
              median([](const Times& t) { return t.total; }), median([](const Times& t) { return t.cells; }),
              median([](const Times& t) { return t.stages.field_ms; }),
              median([](const Times& t) { return t.stages.octree_ms; }),
              median([](const Times& t) { return t.stages.smooth_ms; }),
              median([](const Times& t) { return t.stages.mesh_ms; }), counts.cells, counts.samples, counts.triangles);
}

/// What each slice of a live scan costs: cells, samples taken, bricks smoothed, chunks drawn.
void print_online(const std::string& name, const std::vector<TrackedSlice>& slices, int depth, bool every_slice) {
  Reconstructor reconstructor = make(slices, depth, 2);
  std::vector<double> times;
  if (every_slice)
    std::printf("\n%s, depth %d, slice by slice: ms, cells cut, samples, bricks smoothed, chunks\n", name.c_str(),
                depth);
  for (const TrackedSlice& slice : slices) {
    const auto start = Clock::now();
    const auto report = reconstructor.add(slice);
    const auto update = reconstructor.update();
    times.push_back(ms_since(start));
    if (every_slice && report)
      std::printf("%4zu %7.1f %6u %8zu %6zu %6zu\n", static_cast<std::size_t>(slice.id), times.back(),
                  report->cells_cut, update->samples_evaluated, update->bricks_smoothed, update->chunks_rebuilt);
  }
  const std::vector<double> last(times.begin() + static_cast<std::ptrdiff_t>(times.size() * 2 / 3), times.end());
  std::printf("%-22s depth %d, %3zu slices: all p50 %6.1f p95 %6.1f ms; last third p50 %6.1f p95 %6.1f ms\n",
              name.c_str(), depth, times.size(), quantile(times, 0.5), quantile(times, 0.95), quantile(last, 0.5),
              quantile(last, 0.95));
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = std::filesystem::path(argc > 1 ? argv[1] : "../shared/data") / "csl";
  if (!std::filesystem::exists(folder)) {
    std::printf("SKIP: %s is absent\n", folder.c_str());
    return 0;
  }
  std::printf(
      "medians of %d runs, ms\n%-22s d t    total   cells   field  octree  smooth    mesh    cells  samples "
      "triangles\n",
      kRuns, "set");
  for (const char* set : kSets) {
    const auto file = read_csl(folder / (std::string(set) + ".csl"));
    if (!file) continue;
    for (const int threads : {1, 2}) print_batch(set, file->slices, 8, threads);
  }
  std::printf("\nslices inserted one by one, mesh after each\n");
  for (const char* set : kSets)
    if (const auto file = read_csl(folder / (std::string(set) + ".csl"))) print_online(set, file->slices, 8, false);
  if (const auto file = read_csl(folder / "Vetebrae.csl")) print_online("Vetebrae", file->slices, 8, true);
}
