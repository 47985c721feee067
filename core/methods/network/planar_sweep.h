#pragma once
// a planar network in a convex polygon -> [SWEEP] -> triangles
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/network/exact.h"

namespace sonoloft::network {

/// A point of a network, and the straight lines that it was put on: three points of one line need no arithmetic.
struct SheetPoint {
  Point at;
  std::vector<std::uint32_t> lines;
};

/// The turn of a -> b -> c, exactly.
[[nodiscard]] int turn_at(const SheetPoint& a, const SheetPoint& b, const SheetPoint& c);

/// Triangulates what a convex polygon holds, along all edges given. Counter-clockwise triangles, none without area.
/// @param points  [#V] those without edges are passed over; the others are distinct
/// @param edges   [#E] the polygon's sides and what lies in it; they meet in common ends only, none twice; no point
/// lies
///                within an edge
/// @cost  O(#V log #V)
/// Source: Hertel, Mehlhorn 1983, Fast triangulation of simple polygons.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(
    std::span<const SheetPoint> points, std::span<const std::array<std::uint32_t, 2>> edges);

}  // namespace sonoloft::network
