// How the cost grows with one thing at a time, on simulated scans: bench_scaling <curve>. One process a curve, so that
// its peak of memory is its own; every point of a curve is one line of JSON.
#include <cmath>
#include <functional>
#include <map>

#include "tests/bench/scaling/phantom_scans.h"
#include "tests/bench/support/reconstruction.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

constexpr int kDepth = 8;
constexpr std::size_t kPlanes = 20;

void emit_point(const std::string& curve, double x, nlohmann::json figures) {
  char words[100];
  std::snprintf(words, sizeof words, "%s %g: %.1f ms, peak %.0f MiB", curve.c_str(), x,
                figures["total_ms"].get<double>(), peak_memory_mib());
  figures.update({{"bench", "scaling"}, {"curve", curve}, {"x", x}, {"peak_memory_mib", peak_memory_mib()}});
  emit(figures, words);
}

/// One point: all slices at once, in the box and with the spacing that `depth` gives.
void batch_point(const std::string& curve, double x, std::span<const TrackedSlice> slices, int depth = kDepth,
                 int threads = 1) {
  ReconstructorOptions options = or_exit(options_for(slices, depth));
  options.threads = threads;
  const Batch batch = median_batch(slices, options, 3, 2000);
  nlohmann::json figures = batch.times;
  figures["counts"] = batch.counts;
  emit_point(curve, x, figures);
}

/// Slices one by one, the mesh brought up to date after each.
void one_by_one(const std::string& curve, std::span<const TrackedSlice> slices) {
  ReconstructorOptions options = or_exit(options_for(slices, kDepth));
  options.threads = 2;
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  for (const TrackedSlice& slice : slices) {
    StageTimes times;
    const auto start = Clock::now();
    times.cells_ms = or_exit(reconstructor.add(slice)).cells_ms;
    const UpdateReport report = or_exit(reconstructor.update());
    times.total_ms = ms_since(start);
    times.field_ms = report.field_ms;
    times.octree_ms = report.octree_ms;
    times.smooth_ms = report.smooth_ms;
    times.mesh_ms = report.mesh_ms;
    nlohmann::json figures = times;
    figures["counts"] = reconstructor.counts();
    emit_point(curve, static_cast<double>(slice.id + 1), figures);
  }
}

void slices_curve() {
  one_by_one("slices", free_planes(device_sim::organs_phantom(), 200));
}

void stack_curve() {
  one_by_one("stack", parallel_planes(device_sim::organs_phantom(), 200));
}

void vertices_curve() {
  const std::vector<TrackedSlice> slices = free_planes(bumpy_body(), kPlanes);
  for (const double points : {1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6}) {
    const std::vector<TrackedSlice> scan = resampled(slices, static_cast<std::size_t>(points));
    batch_point("vertices", static_cast<double>(point_count(scan)), scan);
  }
}

void depth_curve() {
  const std::vector<TrackedSlice> slices = free_planes(device_sim::organs_phantom(), kPlanes);
  for (int depth = 6; depth <= 10; ++depth) batch_point("depth", depth, slices, depth);
}

/// The contours stay the same to the last point, their labels do not.
void labels_curve() {
  const std::vector<TrackedSlice> apart = free_planes(bead_chain(false), kPlanes);
  const std::vector<TrackedSlice> touching = free_planes(bead_chain(true), kPlanes);
  for (int labels = 1; labels <= kBeads; labels *= 2) batch_point("labels apart", labels, with_labels(apart, labels));
  for (int labels = 2; labels <= kBeads; labels *= 2)  // of one label there would be no walls between the beads
    batch_point("labels touching", labels, with_labels(touching, labels));
}

void threads_curve() {
  const std::vector<TrackedSlice> slices = free_planes(device_sim::organs_phantom(), kPlanes);
  for (const int threads : {1, 2}) batch_point("threads", threads, slices, 9, threads);
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, std::function<void()>> curves{{"slices", slices_curve},     {"stack", stack_curve},
                                                            {"vertices", vertices_curve}, {"depth", depth_curve},
                                                            {"labels", labels_curve},     {"threads", threads_curve}};
  const auto curve = argc == 2 ? curves.find(argv[1]) : curves.end();
  if (curve == curves.end()) {
    std::fprintf(stderr, "usage: bench_scaling slices|stack|vertices|depth|labels|threads\n");
    return 2;
  }
  curve->second();
}
