#pragma once
// Stage 0:  TrackedSlice -> [SECTION] -> cells -> field -> octree -> mesh -> callback
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
/// No two edges cross or overlap, they meet in their end points only; the labels agree around every point; every point
/// is used. Frame: image, mm (see TrackedSlice).
struct Section {
  Eigen::Isometry3d image_to_reference = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> points;   ///< [#V] on a grid of 2^-30 of the slice's extent (see make_section)
  std::vector<SectionEdge> edges;        ///< [#E]
  Label border = kOutside;               ///< label far away: outside, or unknown where the field of view is bounded
  std::uint32_t repaired_crossings = 0;  ///< points at which contours crossed themselves or each other and were split
};

/// Limits on one slice; more is an error, not a slow scan.
inline constexpr std::uint32_t kMaxSlicePoints = 1u << 20;  ///< of all contours and of the field of view together
inline constexpr std::uint32_t kMaxSliceContours = 1u << 14;
inline constexpr double kMaxCoordinate_mm = 1e9;  ///< of points and of the pose's translation
inline constexpr double kRigidTolerance = 1e-6;   ///< on every element of R^T R - 1

/// Resolves nesting, shared borders, repeated points and crossings of a slice's contours by the rule of TrackedSlice;
/// of several contours of one area and kind the first decides. The field of view does not count as a contour that
/// crosses others.
/// @post  points moved by at most 2^-30 of the extent (of all points, rounded up to a power of 2): they lie on a grid;
///        the section depends on nothing but the slice: not on the start or direction of a contour
/// @error non_finite, not_rigid, bad_contour (fewer than 3 points, points not in the slice, out of range, reserved
///        label), too_large (also contours that cross each other 2^18 times)
/// @cost  O((#V + crossings) log #V); about 0.4 us a point
/// Threads: any; nothing is shared.
/// Source: snap rounding (Hobby 1999), then a plane sweep; all decisions are exact in integers.
[[nodiscard]] Result<Section> make_section(const TrackedSlice& slice);

/// The label of a point of the slice (image frame, mm); on an edge, of either side. O(#E): for tests, tools and single
/// queries.
/// @pre  the section is as make_section() gives it
[[nodiscard]] Label label_at(const Section& section, const Eigen::Vector2d& point_mm);

}  // namespace sonoloft
