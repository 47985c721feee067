#pragma once
// make_section, step 1 of 2:  contours -> [SPLIT] -> segments that meet in their ends only -> label_sweep -> Section
#include <compare>
#include <cstdint>
#include <vector>

namespace sonoloft {

/// A point of the slice's grid; x and y are 0..2^30 + 1, so that orient() fits 64 bits. Ordered by x, then y.
struct GridPoint {
  std::int32_t x, y;
  friend auto operator<=>(const GridPoint&, const GridPoint&) = default;
};

/// Twice the signed area of a, b, c: positive where c lies left of a -> b. Exact; below 2^62.
constexpr std::int64_t orient(GridPoint a, GridPoint b, GridPoint c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

/// A segment (a < b) of the contour number `owner`.
struct OwnedSegment {
  GridPoint a, b;
  std::uint32_t owner;
  friend auto operator<=>(const OwnedSegment&, const OwnedSegment&) = default;
};

/// Limits on one slice's tangle, met only by what is no picture of anything (thousands of long strokes side by side or
/// across each other); they keep the time within seconds and the memory within a few hundred MB.
inline constexpr std::uint64_t kMaxBoxTests = 1ull << 27;
inline constexpr std::size_t kMaxCrossings = std::size_t{1} << 18;
inline constexpr std::size_t kMaxAddedPieces = std::size_t{1} << 19;  ///< counted for each owner

/// Sorts segments and removes what an owner holds an even number of times: it does not bound what that owner encloses.
void cancel_pairs(std::vector<OwnedSegment>& segments);

struct SplitResult {
  bool too_tangled = false;     ///< a limit was met: segments are not usable
  std::uint32_t crossings = 0;  ///< points at which two segments of owners other than `uncounted_owner` crossed
};

/// Splits segments at crossings, touching ends and overlaps, and rounds the new points to the grid, moving no segment
/// by more than half a grid step. A crossing of two different segments that share an owner counts as well.
/// @pre   segments as left by cancel_pairs(); no owner is above uncounted_owner
/// @post  segments as left by cancel_pairs(); any two of different ends meet in common ends only
/// @cost  O((#S + #crossings) log #S) where segments are short against the slice
/// Source: Hobby 1999, Practical segment intersection with finite precision output (snap rounding), sections 2 and 3.
[[nodiscard]] SplitResult split_at_crossings(std::vector<OwnedSegment>& segments, std::uint32_t uncounted_owner);

}  // namespace sonoloft
