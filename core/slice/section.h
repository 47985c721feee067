#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/slice/label.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// A straight piece of the border between two labels of a slice.
struct SectionEdge {
  std::uint32_t a, b;  ///< indices into Section::points
  Label left, right;   ///< labels left and right of a -> b, seen with the normal towards the eye; never equal
};

/// A slice as the reconstruction wants it: a planar straight-line network with a label on both sides of every edge.
/// No two edges cross or overlap, they meet in their end points only; the labels agree around every point.
/// Frame: image, mm (see TrackedSlice).
struct Section {
  Eigen::Isometry3d image_to_reference = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> points;  ///< [#V] on a grid of 2^-30 of the slice's extent
  std::vector<SectionEdge> edges;       ///< [#E]
  Label border = kOutside;              ///< label far away: outside, or unknown where the field of view is bounded
  std::uint32_t repaired_crossings = 0;  ///< contours that crossed themselves or each other were split at this many points
};

/// Limits on one slice; more is an error, not a slow scan.
inline constexpr std::uint32_t kMaxSlicePoints = 1u << 20;
inline constexpr std::uint32_t kMaxSliceContours = 1u << 14;

/// Resolves nesting, shared borders, repeated points and crossings of a slice's contours.
/// @error non_finite, not_rigid, bad_contour (fewer than 3 points, points out of range), too_large
/// @cost  O((#V + crossings) log #V)
[[nodiscard]] Result<Section> make_section(const TrackedSlice& slice);

/// The label of a point of the slice (image frame, mm). O(#E): for tests, tools and single queries.
[[nodiscard]] Label label_at(const Section& section, const Eigen::Vector2d& point_mm);

}  // namespace sonoloft
