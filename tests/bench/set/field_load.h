#pragma once
#include <span>

#include "core/reconstructor/reconstructor.h"

namespace sonoloft::bench {

/// How many edges the field sums over all samples of all slices at once: the work that the field's time is spent on.
[[nodiscard]] double edge_evaluations(std::span<const TrackedSlice> slices, const ReconstructorOptions& options);

}  // namespace sonoloft::bench
