#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "core/mesh/lattice_position.h"
#include "core/slice/four.h"

namespace sonoloft {

/// The samples of a brick and of the first layers of the bricks above it, 0..8 in each axis: all corners of its cells.
/// x runs fastest.
struct BlockGrid {
  static constexpr int kSide = kBrickSize + 1;
  static constexpr int kLayer = kSide * kSide;
  static constexpr int kPoints = kSide * kLayer;
  static constexpr int kRows = kPoints / kSide;
  static constexpr int index(int x, int y, int z) { return x + kSide * y + kLayer * z; }
  /// From a cell's lowest corner to its corner c.
  static constexpr std::array<int, 8> kCorner = {0,      1,          kSide,          kSide + 1,  // index() of (0..1)^3
                                                 kLayer, kLayer + 1, kLayer + kSide, kLayer + kSide + 1};
};
using BlockLabels = std::array<Label, BlockGrid::kPoints>;

/// What a cell is decided from: the labels of its 8 corners, the shares of those labels in all corners, and how far
/// these are from the nearest slice.
struct CellSamples {
  int label_count;                            ///< 1..8
  std::array<Label, 8> label;                 ///< [label_count] ascending
  std::array<std::uint8_t, 8> corners;        ///< [label_count] bit set of the corners with that label
  std::array<std::uint8_t, 8> owner;          ///< [8] index into label of each corner
  std::array<std::array<float, 8>, 8> share;  ///< [label_count][8]
  std::array<float, 8> slice_steps;           ///< see Brick
};

inline float square_root(float a) {
  return std::sqrt(a);
}
inline Four square_root(Four a) {
  return Four{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}

/// From the difference of two labels' shares to something of the same sign that is linear along an edge. At a distance
/// h from a slice the difference is the sine of the angle between the slice's normal and the direction in which the
/// border on the slice is seen, of which h * tangent is linear in space; the sine alone, which is flat above a border
/// and steep beside it, would put the border up to half an edge beside its place.
/// @tparam T  float, or Four to compute all lanes
template <class T>
T way_to_border(T difference, T slice_steps) {
  // Least distance from a slice and least cosine^2: samples on a slice say on which side of a border they are, no more.
  const T nearest_slice = T{} + 1e-3F, least_cos2 = T{} + 1e-6F;
  const T cos2 = 1 - difference * difference;
  const T tangent = difference / square_root(cos2 < least_cos2 ? least_cos2 : cos2);
  const T near = (slice_steps < nearest_slice ? nearest_slice : slice_steps) * tangent;
  return slice_steps < kFarFromSlices ? near : kFarFromSlices * difference;
}

}  // namespace sonoloft
