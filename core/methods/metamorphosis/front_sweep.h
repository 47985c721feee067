#pragma once
#include <cstdint>
#include <vector>

#include "core/methods/metamorphosis/swept_parts.h"
#include "core/methods/stack/passage.h"

namespace sonoloft {

/// What ends for want of a counterpart does so at this share of the height to the next slice.
inline constexpr float kEnd = 0.5F;

/// A node that the front passes or comes near: at share t of its height, the front is  start + change * way(t)  away,
/// positive where the node is inside.
struct FrontNode {
  enum class Course : std::uint8_t {
    between,     ///< from slice to slice, t = 0 in the lower one
    from_lower,  ///< from the lower slice to an end, t = 1 at share kEnd of the height
    from_upper,  ///< the same from the upper slice downwards
  };
  std::uint32_t node;
  Course course;
  float start_mm, change_mm;
  Passage passage;  ///< of an end, only the slope at its start counts
};

/// Parts of a slice that have nothing opposite.
struct Unmatched {
  std::size_t parts = 0, holes = 0;
  double area_mm2 = 0;
};

/// A front's way from one slice to the next.
struct FrontSweep {
  std::vector<float> speed;  ///< [#nodes] mean speed there, mm of way per mm of height; positive where inside grows
  std::vector<FrontNode> nodes;
  Unmatched in_lower, in_upper;
};

/// All but the passages, which depend on the slices beyond.
/// @cost O(#nodes), and O(n log n) in the nodes that it returns
[[nodiscard]] FrontSweep sweep_between(const PlaneGrid& grid, const SlicePair& slices, double height_mm);

}  // namespace sonoloft
