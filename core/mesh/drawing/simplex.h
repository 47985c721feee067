#pragma once
#include <array>
#include <bit>

#include "core/mesh/lattice_position.h"

namespace sonoloft {

/// Corners of a cell: bit c for corner c.
using CornerSet = unsigned;

constexpr CornerSet kAllCorners = 0xFF;
/// An even number of steps away from corner 0.
constexpr CornerSet kEvenCorners = 0x69;

constexpr CornerSet set_of(unsigned corner) {
  return 1u << corner;
}
constexpr unsigned first_of(CornerSet corners) {
  return static_cast<unsigned>(std::countr_zero(corners));
}
constexpr CornerSet first_alone(CornerSet corners) {
  return corners & (0u - corners);
}

/// The corners of a cell with an even sum of lattice coordinates: two on a diagonal of every face.
constexpr CornerSet even_points(LocalPoint cell) {
  return ((cell.x ^ cell.y ^ cell.z) & 1) == 0 ? kEvenCorners : kEvenCorners ^ kAllCorners;
}

/// A cell in five tetrahedra: a regular one of the even points, and each other corner with the three beside it. Those
/// of all cells fit together, since a face is cut along the diagonal of its even points.
/// They are used for their shape: with nodes near the middles, no surface in them needs an angle below 30 degrees.
constexpr std::array<CornerSet, 5> tetrahedra(CornerSet even) {
  std::array<CornerSet, 5> result{even};
  CornerSet odd = even ^ kAllCorners;
  for (std::size_t i = 1; i < 5; ++i, odd &= odd - 1) {
    const unsigned c = first_of(odd);
    result[i] = set_of(c) | set_of(c ^ 1) | set_of(c ^ 2) | set_of(c ^ 4);
  }
  return result;
}

/// The corner of a triangle or tetrahedron in which its lattice edges meet; none if it has no lattice edge.
constexpr CornerSet right_angle(CornerSet simplex) {
  const CornerSet even = simplex & kEvenCorners, odd = simplex & ~kEvenCorners;
  if (even == 0 || odd == 0) return 0;
  return std::has_single_bit(even) ? even : odd;
}

/// A simplex of this subdivision, told from others by its lowest point, the least in each axis, and a kind.
struct SimplexName {
  std::uint8_t lowest = 0;  ///< as a corner of the cell
  std::uint8_t kind = 0;    ///< 1..kSimplexKinds - 1
};
inline constexpr auto kSimplexNames = [] {  // [CornerSet]
  std::array<SimplexName, kAllCorners + 1> names;
  for (CornerSet simplex = 1; simplex <= kAllCorners; ++simplex) {
    unsigned lowest = 7, highest = 0;
    for (CornerSet rest = simplex; rest != 0; rest &= rest - 1) {
      lowest &= first_of(rest);
      highest |= first_of(rest);
    }
    const CornerSet right = right_angle(simplex);
    const CornerSet same = (simplex & kEvenCorners) != 0 ? kEvenCorners : kEvenCorners ^ kAllCorners;
    // Which of those that span the same: by its right angle; a face of the regular tetrahedron by the corner opposite.
    constexpr unsigned kByOwnCorner = 1u << 6;
    unsigned which = 0;
    if (std::popcount(simplex) > 2)
      which = right != 0        ? kByOwnCorner | (first_of(right) ^ lowest) << 3
              : same == simplex ? kByOwnCorner | first_of(simplex) << 3
                                : first_of(same & ~simplex) << 3;
    names[simplex] = {static_cast<std::uint8_t>(lowest), static_cast<std::uint8_t>((highest ^ lowest) | which)};
  }
  return names;
}();

}  // namespace sonoloft
