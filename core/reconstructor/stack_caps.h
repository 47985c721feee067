#pragma once
#include <span>
#include <vector>

#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// Slices in parallel planes do not say where the object ends beyond the first and the last of them. These two empty
/// slices do: they lie that many mm, or gaps between the last two slices, beyond the ends. Without them the surface
/// runs out towards the walls of the box. A flat end then closes about half way to its cap, which for one gap is the
/// mean for slices placed at random; 0 closes it at the slice.
/// @param  gaps            >= 0
/// @param  least_mm        caps lie no nearer, since cells must have some width: half a finest cell will do; > 0
/// @return to be added after all others; none when there are less than two slices, or when their planes lean against
///         each other by more than 1 degree: then they see the ends from the side
[[nodiscard]] std::vector<TrackedSlice> stack_caps(std::span<const TrackedSlice> slices, double gaps, double least_mm);

}  // namespace sonoloft
