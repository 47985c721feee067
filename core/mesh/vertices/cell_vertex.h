#pragma once
#include <array>

#include "core/mesh/vertices/cell_samples.h"

namespace sonoloft {

/// True if the surface around every label is one disc inside the cell, whatever the other labels are: the corners of
/// each label, and all the others, are connected along edges of the cube. Then one vertex serves all of them.
[[nodiscard]] bool is_simple(const CellSamples& cell);

/// The corners of the faces as bit sets, in the order of the bits of mixed_faces().
inline constexpr std::array<unsigned, 6> kFaceCorners = {0x55, 0xAA, 0x33, 0xCC, 0x0F, 0xF0};

/// Faces of the cell (bit 2 * axis + side) that touch all of its labels, and those that touch more than one.
[[nodiscard]] unsigned faces_with_all_labels(const CellSamples& cell);
[[nodiscard]] unsigned mixed_faces(const CellSamples& cell);

/// The edges along an axis whose ends differ in label: a bit set of their lower ends.
inline unsigned mixed_edges(const CellSamples& cell, unsigned axis) {
  constexpr std::array<unsigned, 3> kLower = {0x55, 0x33, 0x0F};
  unsigned mixed = 0;
  for (std::size_t i = 1; i < static_cast<std::size_t>(cell.label_count); ++i)
    mixed |= cell.corners[i] ^ static_cast<unsigned>(cell.corners[i]) >> (1u << axis);
  return mixed & kLower[axis];
}

/// Where a gap between two labels vanishes between two corners where one and the other is the stronger: 0 at `lower`,
/// 1 at `upper`, kept 0.01 inside, since no two simplices may share a node; the middle where the samples do not say.
/// The same bits, whichever of both labels is first.
/// @tparam T  float, or Four to compute all lanes
template <class T>
T zero_between(T lower, T upper) {
  const T least = T{} + 0.01F, most = T{} + (1 - 0.01F);
  const T t = lower / (lower - upper), size = t < 0 ? -t : t;
  const T above = t < least ? least : t, inside = above > most ? most : above;
  return size <= 1e6F ? inside : T{} + 0.5F;  // 0/0, NaN: the samples do not say
}

/// Where the labels of two corners that differ are equally strong on the line between them, see zero_between(). Depends
/// on the samples of these two corners alone, so that every cell with this line finds the same bits. Exact beside a
/// slice that the border crosses in a straight line, at whatever angle (docs/pipeline/6-mesh.md).
[[nodiscard]] float crossing(const CellSamples& cell, unsigned lower, unsigned upper);

}  // namespace sonoloft
