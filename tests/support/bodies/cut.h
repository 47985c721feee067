#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/slice/tracked_slice.h"
#include "device_sim/probe/phantom.h"

namespace sonoloft::test {

/// What a plane cuts out of a body. Bodies by formulas come as polylines of at least 400 points a diagonal, with every
/// point exact to 1e-6 of that spacing; borders of two labels have identical points on both sides.
[[nodiscard]] TrackedSlice cut(const device_sim::SectionSource& body, const Eigen::Isometry3d& plane, std::uint64_t id);

/// A slice for each plane, with ids 0, 1, ...
[[nodiscard]] std::vector<TrackedSlice> cut(const device_sim::SectionSource& body,
                                            std::span<const Eigen::Isometry3d> planes);

/// Moves every contour point in its plane by normal noise of `sigma_mm` along each axis, independent for each point and
/// slice; points that loops share stay shared. Holes stay holes.
[[nodiscard]] std::vector<TrackedSlice> with_noise(std::vector<TrackedSlice> slices, double sigma_mm,
                                                   std::uint64_t seed);

}  // namespace sonoloft::test
