#pragma once
// vertices of cells, contours through them -> [CONTOUR SNAP] -> vertices on the contours
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/vertices/cell_lanes.h"
#include "core/mesh/vertices/sample_block.h"

namespace sonoloft {

/// A straight piece of a contour within a simple cell of the two labels that it parts. Lattice steps from the cell's
/// lowest corner.
struct ContourSpan {
  std::uint32_t slot;  ///< of the cell, see BrickCells
  std::array<float, 3> a, b;
  std::uint32_t ends;  ///< bit 0: a, bit 1: b is an end of an edge of the contour, not only of this piece
};

/// What of some contours runs through the cells of a brick.
/// @param slot    [kBrickSamples] see BrickCells
/// @param pairs   [#S] labels of the cells; pieces of contours between other labels are none of theirs
/// @param spans   ascending by cell, those of a cell in the order of the contours
void spans_of(std::span<const ContourPiece> contours, std::span<const std::uint16_t> slot,
              std::span<const LabelPair> pairs, std::vector<ContourSpan>& spans);

/// Puts the vertex of a cell on the contours through it: on a corner that the surface would cut off, of several on the
/// farthest from the surface; else on the nearest point; the first of equals.
/// @param spans   those of the cell, at least one
/// @param vertex  on the surface
/// @param gap     that of the cell
[[nodiscard]] CellPoint put_on_contour(std::span<const ContourSpan> spans, const CellPoint& vertex, const Gap& gap);

}  // namespace sonoloft
