#pragma once
#include <optional>

#include "core/mesh/drawing/chunk_buffer.h"
#include "core/mesh/drawing/quad.h"
#include "core/mesh/vertices/brick_net.h"

namespace sonoloft {

/// The four cell vertices around a lattice edge, relative to its lower end in 1/65536 steps, in coordinates (u, v, w)
/// with w along the edge and u, v the next axes; corner i lies in quadrant i of (u, v), counter-clockwise.
using EdgeQuad = Quad;

/// Which diagonal cuts the quad into two triangles that stay inside the envelope of the edge (the four tetrahedra of
/// the edge and two consecutive corners), where no other part of the mesh can be: 0 for corners 0-2, 1 for 1-3; of two
/// the one with the larger smallest angle; none if neither does. Exact: every product fits into 53 bits.
/// Source: Ju, Udeshi 2006, section 4, for cubes of one size.
[[nodiscard]] std::optional<int> safe_diagonal(const EdgeQuad& quad);

/// Draws the surface that crosses a lattice edge, as far as it lies in simple cells: a quad when all four cells around
/// the edge are simple, otherwise, or when neither diagonal is safe, triangles about a node on the edge.
/// @return true if a quad had to be drawn as four triangles
bool draw_edge(const NetGrid& nets, const MixedEdge& edge, ChunkBuffer& chunk);

}  // namespace sonoloft
