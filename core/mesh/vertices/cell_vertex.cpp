#include "core/mesh/vertices/cell_vertex.h"

#include <algorithm>
#include <cstddef>

namespace sonoloft {
namespace {

constexpr unsigned kAllCorners = 0xFF;

/// The faces that a set of corners touches.
constexpr auto kTouchedFaces = [] {
  std::array<std::uint8_t, 256> touched{};
  for (unsigned corners = 0; corners < 256; ++corners)
    for (unsigned face = 0; face < 6; ++face)
      if ((corners & kFaceCorners[face]) != 0) touched[corners] |= static_cast<std::uint8_t>(1u << face);
  return touched;
}();

constexpr bool connected_along_edges(unsigned corners) {
  unsigned reached = corners & (0u - corners);
  for (int step = 0; step < 7; ++step)
    for (unsigned c = 0; c < 8; ++c)
      if (reached >> c & 1) reached |= corners & (1u << (c ^ 1) | 1u << (c ^ 2) | 1u << (c ^ 4));
  return reached == corners;
}

constexpr auto kSimple = [] {
  std::array<bool, 256> simple{};
  for (unsigned corners = 0; corners < 256; ++corners)
    simple[corners] = connected_along_edges(corners) && connected_along_edges(~corners & kAllCorners);
  return simple;
}();

}  // namespace

bool is_simple(const CellSamples& cell) {
  return std::all_of(cell.corners.begin(), cell.corners.begin() + cell.label_count,
                     [](std::uint8_t corners) { return kSimple[corners]; });
}

unsigned faces_with_all_labels(const CellSamples& cell) {
  unsigned faces = ~0u;
  for (std::size_t i = 0; i < static_cast<std::size_t>(cell.label_count); ++i) faces &= kTouchedFaces[cell.corners[i]];
  return faces;
}

unsigned mixed_faces(const CellSamples& cell) {
  unsigned touched = 0, mixed = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(cell.label_count); ++i) {
    mixed |= touched & kTouchedFaces[cell.corners[i]];
    touched |= kTouchedFaces[cell.corners[i]];
  }
  return mixed;
}

float crossing(const CellSamples& cell, unsigned lower, unsigned upper) {
  const auto& a = cell.share[cell.owner[lower]];
  const auto& b = cell.share[cell.owner[upper]];
  return zero_between(way_to_border(a[lower] - b[lower], cell.slice_steps[lower]),
                      way_to_border(a[upper] - b[upper], cell.slice_steps[upper]));
}

}  // namespace sonoloft
