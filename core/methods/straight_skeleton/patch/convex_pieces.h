#pragma once
#include <optional>
#include <vector>

#include "core/methods/straight_skeleton/patch/patch_map.h"

namespace sonoloft::skeleton {

/// A straight stretch of a rim of the patch.
struct RimLine {
  Spot a, b;  ///< the patch is on the left
};

/// A side of a convex piece: along a rim of the patch or along the continuation of one, with the rim's own line, so
/// that sides on one line are known to be.
struct PieceSide {
  Spot a, b;                          ///< the piece is on the left
  std::optional<std::uint32_t> line;  ///< of the rims; none: the end of what is looked at
  int sign;                           ///< -1: the piece is on the right of that line
};

struct ConvexPieces {
  std::vector<RimLine> lines;
  std::vector<std::vector<PieceSide>> pieces;  ///< counter-clockwise
};

/// Cuts a patch at each reflex corner along the continuation of the side that arrives there, up to the next rim or cut:
/// so two sides that meet there are sides of two pieces, and none is added that could send out a front of its own.
/// @param reach_mm  an unbounded patch is looked at in a square of this half-width
/// @cost O(#reflex corners * #sides)
[[nodiscard]] ConvexPieces convex_pieces(const PatchMap& map, double reach_mm);

}  // namespace sonoloft::skeleton
