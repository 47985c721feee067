#pragma once
// Complete slices -> [MASKS] -> slices of which a part was not measured
#include <cstdint>
#include <span>
#include <vector>

#include "core/slice/tracked_slice.h"

namespace sonoloft::test {

enum class Mask : std::uint8_t {
  blobs,       ///< discs of 14 corners over the labels, apart from each other, are unknown
  half_plane,  ///< all on one side of a line of a random direction is unknown
  window,      ///< all around a rectangle at a random place, in a random direction, is unknown
};

/// The slices with a part of each one unknown; slices without a label stay as they are. What is known keeps its labels.
/// @param share  of the labelled area of every slice that becomes unknown, 0 < share < 0.8, to about 0.02
/// @param seed   the same seed gives the same masks; so does a slice, whatever comes before it
/// @pre   make_section() accepts every slice; none has a field of view
[[nodiscard]] std::vector<TrackedSlice> masked(std::span<const TrackedSlice> slices, Mask mask, double share,
                                               std::uint64_t seed);

}  // namespace sonoloft::test
