#pragma once
#include "core/mesh/drawing/chunk_buffer.h"
#include "core/mesh/vertices/brick_net.h"

namespace sonoloft {

/// The index of the vertex on a lattice edge, where the labels of its ends meet.
[[nodiscard]] std::uint32_t edge_node(const MixedEdge& edge, ChunkBuffer& chunk);

/// Draws what lies in a cell that is not simple: marching tetrahedra in the twelve between its centre and its faces,
/// and for each simple cell beside it the cone from that cell's vertex over what the tetrahedra leave on the common
/// face.
void draw_complex_cell(const CellSamples& samples, const NetGrid& nets, LocalPoint cell, ChunkBuffer& chunk);

}  // namespace sonoloft
