#pragma once
#include <algorithm>
#include <array>
#include <bit>

#include "core/mesh/lattice_position.h"

namespace sonoloft {

/// Points of a cell, of which a simplex is made: bit c for corner c, and one for the cell's centre.
using PointSet = unsigned;
inline constexpr unsigned kCentre = 8;
inline constexpr PointSet kCentreAlone = 1u << kCentre;
inline constexpr PointSet kAllCorners = kCentreAlone - 1;

constexpr unsigned first_of(PointSet points) {
  return static_cast<unsigned>(std::countr_zero(points));
}
constexpr PointSet first_alone(PointSet points) {
  return points & (0u - points);
}
constexpr PointSet without_first(PointSet points) {
  return points & (points - 1);
}

/// A simplex, told from all others of a lattice by its lowest point and a kind: the same in all cells that it is in.
struct SimplexName {
  std::uint8_t lowest = 0;  ///< as a corner of the cell
  std::uint8_t kind = 0;    ///< 1..kSimplexKinds - 1
};

/// [PointSet] of two or three corners of a face, and of the centre with one to three corners of a face.
inline constexpr auto kSimplexNames = [] {
  std::array<SimplexName, 2 * kCentreAlone> names;
  unsigned kinds = 0;
  for (PointSet simplex = 1; simplex < names.size(); ++simplex) {
    const PointSet corners = simplex & ~kCentreAlone;
    const bool inside = corners != simplex;
    unsigned lowest = 7, highest = 0;
    for (PointSet rest = corners; rest != 0; rest = without_first(rest)) {
      lowest &= first_of(rest);
      highest |= first_of(rest);
    }
    if (std::popcount(highest ^ lowest) > 2 || std::popcount(corners) > 3 || std::popcount(simplex) < 2) continue;
    if (inside) lowest = 0;  // in one cell only; others are the same as those that lie likewise from their lowest point
    PointSet likewise = simplex & kCentreAlone;
    for (PointSet rest = corners; rest != 0; rest = without_first(rest)) likewise |= 1u << (first_of(rest) ^ lowest);
    if (names[likewise].kind == 0) names[likewise].kind = static_cast<std::uint8_t>(++kinds);
    names[simplex] = {static_cast<std::uint8_t>(lowest), names[likewise].kind};
  }
  return names;
}();
static_assert(std::ranges::max(kSimplexNames, {}, &SimplexName::kind).kind < kSimplexKinds);

}  // namespace sonoloft
