#pragma once
// the curves that two faces project on the sheet between them -> [NETWORK] -> triangles
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/medial_axis/axis/cell_curves.h"
#include "core/methods/network/planar_sweep.h"

namespace sonoloft::medial {

/// The stretch of a curve between two waypoints that lies on a sheet.
struct CurveStretch {
  std::uint32_t curve, first;  ///< from roof[first] to roof[first + 1]
};

inline constexpr std::int32_t kNoBorder = -1;

/// What an edge of the network parts, for each of the two faces; kNoBorder where it is no contour of that face.
struct SheetEdge {
  std::array<std::uint32_t, 2> ends;
  std::array<std::int32_t, 2> left{kNoBorder, kNoBorder}, right{kNoBorder, kNoBorder};  ///< [face f, face g]
};

/// A sheet's outline and the curves of both faces on it, cut where they meet. All in the image of face f.
struct SheetNetwork {
  /// Puts the vertices where curves meet into `curves`, and onto the curves as cuts.
  SheetNetwork(const CurveNetwork& network, const CellAxis& axis, std::uint32_t sheet,
               std::span<const CurveStretch> stretches, CellCurves& curves);

  std::vector<std::uint32_t> vertices;  ///< [#V] of the cell
  std::vector<SheetPoint> points;       ///< [#V]
  std::vector<SheetEdge> edges;         ///< as triangulate() wants them
};

}  // namespace sonoloft::medial
