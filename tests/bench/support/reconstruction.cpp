#include "tests/bench/support/reconstruction.h"

#include "core/io/slices/slice_files.h"
#include "host/scan/pace.h"

namespace sonoloft::bench {

std::vector<TrackedSlice> read_set(const std::filesystem::path& file) {
  return or_exit(file.extension() == ".contour" ? read_contour(file) : read_csl(file)).slices;
}

Batch run_batch(std::span<const TrackedSlice> slices, const ReconstructorOptions& options) {
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  Batch batch;
  const auto start = Clock::now();
  for (const TrackedSlice& slice : slices) batch.times.cells_ms += or_exit(reconstructor.add(slice)).cells_ms;
  const UpdateReport report = or_exit(reconstructor.update());
  batch.times.total_ms = ms_since(start);
  batch.times.field_ms = report.field_ms;
  batch.times.octree_ms = report.octree_ms;
  batch.times.smooth_ms = report.smooth_ms;
  batch.times.mesh_ms = report.mesh_ms;
  batch.counts = reconstructor.counts();
  batch.edge_evaluations = report.edge_evaluations;
  return batch;
}

Batch median_batch(std::span<const TrackedSlice> slices, const ReconstructorOptions& options, std::size_t runs,
                   double enough_ms) {
  std::vector<Batch> batches;
  const auto start = Clock::now();
  do {
    batches.push_back(run_batch(slices, options));
  } while (batches.size() < runs && ms_since(start) < enough_ms);
  Batch result = batches.front();
  for (double StageTimes::*stage : {&StageTimes::total_ms, &StageTimes::cells_ms, &StageTimes::field_ms,
                                    &StageTimes::octree_ms, &StageTimes::smooth_ms, &StageTimes::mesh_ms}) {
    std::vector<double> values;
    for (const Batch& batch : batches) values.push_back(batch.times.*stage);
    result.times.*stage = median(std::move(values));
  }
  return result;
}

std::vector<SliceCost> run_online(std::span<const TrackedSlice> slices, const ReconstructorOptions& options,
                                  std::optional<Clock::duration> between) {
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  Pace pace;
  Clock::time_point arrival;
  Detail detail = Detail::full;
  std::vector<SliceCost> costs;
  for (const TrackedSlice& slice : slices) {
    const auto start = Clock::now();
    const InsertReport inserted = or_exit(reconstructor.add(slice));
    const Pace::SamplesDue due = reconstructor.samples_due();
    if (between) {
      pace.slice_arrived(arrival += *between);
      detail = pace.next(detail, due);
    }
    const UpdateReport updated = or_exit(reconstructor.update(detail, Slopes::streaming));
    pace.took(due[static_cast<std::size_t>(detail)], updated.sampling_ms(), ms_since(start) - updated.sampling_ms());
    costs.push_back({ms_since(start), detail, inserted.cells_cut, updated.samples_evaluated, updated.bricks_smoothed,
                     updated.chunks_rebuilt});
  }
  return costs;
}

}  // namespace sonoloft::bench
