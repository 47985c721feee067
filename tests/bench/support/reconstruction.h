#pragma once
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/reconstructor/reconstructor.h"
#include "tests/bench/support/figures.h"

namespace sonoloft::bench {

/// How long all slices of a scan take, stage by stage.
struct StageTimes {
  double total_ms = 0, cells_ms = 0, field_ms = 0, octree_ms = 0, smooth_ms = 0, mesh_ms = 0;
};

[[nodiscard]] std::vector<TrackedSlice> read_set(const std::filesystem::path& file);

/// All slices at once, in a reconstructor of their own.
struct Batch {
  StageTimes times;
  ReconstructorCounts counts;
  std::size_t edge_evaluations = 0;  ///< of the field
};
[[nodiscard]] Batch run_batch(std::span<const TrackedSlice> slices, const ReconstructorOptions& options);

/// The median of each stage over some runs; none is begun once they took `enough_ms` together.
[[nodiscard]] Batch median_batch(std::span<const TrackedSlice> slices, const ReconstructorOptions& options,
                                 std::size_t runs, double enough_ms = std::numeric_limits<double>::infinity());

/// What one slice of a scan cost.
struct SliceCost {
  double ms = 0;
  Detail detail = Detail::full;  ///< that the mesh was drawn in
  std::size_t cells_cut = 0, samples = 0, bricks_smoothed = 0, chunks_rebuilt = 0;
};

/// Slices one by one, the mesh brought up to date after each.
/// @param between  the time between two slices for which a live scan chooses the detail; none: full
/// @return [#slices]
[[nodiscard]] std::vector<SliceCost> run_online(std::span<const TrackedSlice> slices,
                                                const ReconstructorOptions& options,
                                                std::optional<Clock::duration> between = {});

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SliceCost, ms, detail, cells_cut, samples, bricks_smoothed, chunks_rebuilt)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StageTimes, total_ms, cells_ms, field_ms, octree_ms, smooth_ms, mesh_ms)

}  // namespace sonoloft::bench

namespace sonoloft {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReconstructorCounts, cells, faces, edges, samples, leaves, triangles)
}  // namespace sonoloft
