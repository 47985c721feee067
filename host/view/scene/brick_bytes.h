#pragma once
// MeshChunk -> [BRICK BYTES] -> page
#include <array>
#include <span>
#include <string>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"

namespace sonoloft::view {

/// The chunks around one, itself among them; null where there is none.
using Neighbours = std::array<const MeshChunk*, 27>;

/// A brick as the page draws it: closed surfaces of the materials, each with its own normals, so that a wall between
/// two materials belongs to both. Little-endian:
///   i32 x, y, z; u32 labels; for each label, ascending:
///   u32 label, #V, #I;  f32 positions [#V][3] mm;  i8 [#V][4] of 127: normal, measured;  u32 indices [#I]
/// Normals point out of the material, which their triangles run around counter-clockwise, and are the same on both
/// sides of a brick's border.
/// @param chunk     null: the brick vanished, no label follows
/// @param measured  [#V] of the chunk, 0..1; empty: 1 throughout
/// @cost  O(triangles of the chunk and of those around it)
void append_brick(const BrickCoord& coord, const MeshChunk* chunk, const Neighbours& around,
                  std::span<const float> measured, std::string& out);

/// Triangles that append_brick() writes: one that has a material on both sides counts twice.
[[nodiscard]] std::size_t faces_of(const MeshChunk& chunk);

}  // namespace sonoloft::view
