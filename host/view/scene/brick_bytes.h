#pragma once
// MeshChunk -> [BRICK BYTES] -> page
#include <array>
#include <string>

#include "core/coverage/confidence.h"
#include "core/mesh/mesh.h"
#include "core/octree/brick.h"

namespace sonoloft::view {

/// The chunks around one, itself among them; null where there is none.
using Neighbours = std::array<const MeshChunk*, 27>;

/// A brick as the page draws it: closed surfaces of the materials, each with its own normals, so that a wall between
/// two materials belongs to both. Little-endian:
///   i32 x, y, z; u32 labels; for each label, ascending:
///   u32 label, #V, #I;  f32 positions [#V][3] mm;  i8 [#V][4] of 127: normal, measured;
///   u8 [#V] distance to what was seen, quarters of a mm, 255 also what is farther; zeros up to a multiple of 4;
///   u32 indices [#I]
/// Normals point out of the material, which their triangles run around counter-clockwise, and are the same on both
/// sides of a brick's border.
/// @param chunk  null: the brick vanished, no label follows
/// @param sure   of the vertices of the chunk; empty: measured throughout
/// @cost  O(triangles of the chunk and of those around it)
void append_brick(const BrickCoord& coord, const MeshChunk* chunk, const Neighbours& around, const Confidence& sure,
                  std::string& out);

/// Triangles that append_brick() writes: one that has a material on both sides counts twice.
[[nodiscard]] std::size_t faces_of(const MeshChunk& chunk);

}  // namespace sonoloft::view
