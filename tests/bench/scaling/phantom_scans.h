#pragma once
#include <cstddef>
#include <vector>

#include "core/slice/tracked_slice.h"
#include "device_sim/probe/phantoms/solid_phantom.h"

/// Scans to measure growth with: bodies given by formulas, cut by whole planes.
namespace sonoloft::bench {

/// Planes of any direction through points in the middle half of the phantom's box; the first ones do not depend on the
/// count.
[[nodiscard]] std::vector<TrackedSlice> free_planes(const device_sim::Phantom& phantom, std::size_t count);

/// Parallel planes, one after the other, through the middle half of the phantom's box.
[[nodiscard]] std::vector<TrackedSlice> parallel_planes(const device_sim::Phantom& phantom, std::size_t count);

/// One label with a bay, a handle and a cavity: loops that share no border.
[[nodiscard]] device_sim::SolidPhantom bumpy_body();

/// 32 balls along a helix, each with a label of its own, every one in touch with its neighbours or all apart.
[[nodiscard]] device_sim::SolidPhantom bead_chain(bool touching);
inline constexpr int kBeads = 32;

/// The same contours with about `points` points in all (3 at least for each): smooth curves through the given ones.
/// @pre contours share no points
[[nodiscard]] std::vector<TrackedSlice> resampled(const std::vector<TrackedSlice>& slices, std::size_t points);

/// The same contours with labels 1..count taken in turn.
[[nodiscard]] std::vector<TrackedSlice> with_labels(std::vector<TrackedSlice> slices, int count);

[[nodiscard]] std::size_t point_count(const std::vector<TrackedSlice>& slices);

}  // namespace sonoloft::bench
