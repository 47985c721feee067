#pragma once
#include <cstdint>
#include <vector>

#include "core/methods/stack/plane_grid.h"

namespace sonoloft {

/// Signed distances of two neighbouring slices: [#nodes] mm, positive inside.
struct SlicePair {
  const std::vector<float>*lower, *upper;

  [[nodiscard]] bool in_lower(std::size_t node) const { return (*lower)[node] > 0; }
  [[nodiscard]] bool in_upper(std::size_t node) const { return (*upper)[node] > 0; }
  /// Whether the front passes here on its way from one contour to the other.
  [[nodiscard]] bool swept(std::size_t node) const { return in_lower(node) != in_upper(node); }
};

/// A connected part of what is inside of just one of two slices.
struct SweptPart {
  std::vector<std::uint32_t> nodes;
  bool in_lower = false;                   ///< inside of the lower slice, so that it vanishes on the way up
  std::size_t on_lower = 0, on_upper = 0;  ///< nodes beside the contour of either slice

  /// The contour on one side only: nothing there for the other end of the way.
  [[nodiscard]] bool alone() const { return on_lower == 0 || on_upper == 0; }
};

inline constexpr std::uint32_t kNotSwept = 0xFFFFFFFF;

struct SweptParts {
  std::vector<SweptPart> parts;
  std::vector<std::uint32_t> part_of;  ///< [#nodes] index into parts, or kNotSwept
};

/// @pre the outermost nodes are outside of both slices. @cost O(#nodes)
[[nodiscard]] SweptParts swept_parts(const PlaneGrid& grid, const SlicePair& slices);

}  // namespace sonoloft
