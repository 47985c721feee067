#pragma once
#include <cstdint>
#include <vector>

#include "core/slice/section.h"

namespace sonoloft {

/// A longest chain of edges with the same two labels: a closed loop, or from one junction to another (or the same).
/// Where a border crosses or touches itself, as rough ones do, arcs go on straight. Its direction is that with the
/// greater label on the left.
struct Arc {
  Label left, right;
  std::uint32_t first, count;  ///< places
  bool closed;
  double length_mm;

  /// The border of something unknown is no surface.
  [[nodiscard]] bool is_surface() const { return left != kUnknown; }
  [[nodiscard]] std::uint32_t end() const { return first + count; }
  /// The place after one that is not the last of an open arc.
  [[nodiscard]] std::uint32_t next(std::uint32_t place) const { return place + 1 == end() ? first : place + 1; }
  [[nodiscard]] bool has_edge(std::uint32_t place) const { return closed || place + 1 < end(); }
};

/// All arcs of a section. A place is a point of an arc; where arcs meet, or one itself, the point has several.
struct Arcs {
  std::vector<Arc> arcs;
  std::vector<std::uint32_t> arc;            ///< [#places]
  std::vector<std::uint32_t> point;          ///< [#places] of the section
  std::vector<double> along_mm;              ///< [#places] way from the arc's first place
  std::vector<std::uint32_t> place_of_edge;  ///< [#edges of the section] where each starts, in its arc's direction

  [[nodiscard]] const Arc& arc_at(std::uint32_t place) const { return arcs[arc[place]]; }
};

/// @cost O(#edges)
[[nodiscard]] Arcs arcs_of(const Section& section);

}  // namespace sonoloft
