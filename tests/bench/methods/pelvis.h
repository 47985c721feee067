#pragma once
#include <vector>

#include "core/slice/tracked_slice.h"

namespace sonoloft::bench {

/// A stack as large as the largest that metamorphosis was published with: 35 slices of 420 x 300 nodes at 1 mm, 347 mm
/// high. Two wings that curl as they rise, grow together to a ring, and part again below.
[[nodiscard]] std::vector<TrackedSlice> pelvis();

}  // namespace sonoloft::bench
