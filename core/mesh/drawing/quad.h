#pragma once
#include <algorithm>
#include <array>

#include "core/mesh/lattice_position.h"
#include "core/slice/four.h"

namespace sonoloft {

/// Corners in their order around it.
using Quad = std::array<BrickPoint, 4>;

/// Squared sine of the smallest angle of both triangles, if the quad is cut from corner 0 to 2 and from 1 to 3.
inline std::array<float, 2> sharpness(const Quad& q) {
  Four side[2][3];  // from the first corner of the triangles 012, 023, 123, 130 to both others
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t p0 = q[0][axis], p1 = q[1][axis], p2 = q[2][axis], p3 = q[3][axis];
    const FourInts first = {p0, p0, p1, p1}, second = {p1, p2, p2, p3}, third = {p2, p3, p3, p0};
    side[0][axis] = __builtin_convertvector(second - first, Four);
    side[1][axis] = __builtin_convertvector(third - first, Four);
  }
  const auto norm2 = [](Four x, Four y, Four z) { return x * x + (y * y + z * z); };
  const auto& [x0, y0, z0] = side[0];
  const auto& [x1, y1, z1] = side[1];
  const Four l0 = norm2(x0, y0, z0), l1 = norm2(x1, y1, z1), l2 = norm2(x1 - x0, y1 - y0, z1 - z0);
  // The smallest angle lies between the two longer sides, whose product times its sine is twice the area.
  const Four area2 = norm2(y0 * z1 - z0 * y1, z0 * x1 - x0 * z1, x0 * y1 - y0 * x1);
  const Four least = l1 < l0 ? l1 : l0;
  const Four sharp = area2 * (l2 < least ? l2 : least) / (l0 * l1 * l2);
  return {std::min(sharp[0], sharp[1]), std::min(sharp[2], sharp[3])};
}

/// The first corner of the better diagonal.
inline std::size_t sharper(const std::array<float, 2>& diagonals) {
  return diagonals[0] >= diagonals[1] ? 0 : 1;
}

}  // namespace sonoloft
