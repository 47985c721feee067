#pragma once
// gaps and crossings of simple cells -> [CELL LANES] -> their vertices
#include <array>
#include <cstdint>
#include <span>

#include "core/mesh/lattice_position.h"
#include "core/slice/four.h"

namespace sonoloft {

/// A vertex is moved towards the places where all gaps are zero: f_0 - f_k of the labels of a cell, each as a function
/// that is linear near slices too.
using Gap = std::array<float, 8>;  ///< [corner]

/// The gaps of cells with two labels, 0 in other lanes.
struct GapLanes {
  Four corner[8];
};

/// The gaps of a cell with three labels. Cells with more have none: their vertex stays in the mean of the crossings.
struct LineGaps {
  std::uint32_t slot;  ///< of the cell, see BrickCells; its lane is slot % kFour
  std::array<Gap, 2> gap;
};

/// What tells the crossings on the edges of cells.
struct CrossingLanes {
  FourInts mixed[3];    ///< [axis] mixed_edges()
  FourInts known;       ///< -1 where the gap lanes do not tell the crossings and these do:
  Four crossing[3][4];  ///< [axis][edge]
};

/// Positions in lattice steps from the cell's lowest corner.
struct PointLanes {
  Four axis[3];
};

/// The lower ends of the edges along an axis.
inline constexpr std::array<std::array<unsigned, 4>, 3> kLowerEnds = {{{0, 2, 4, 6}, {0, 1, 4, 5}, {0, 1, 2, 3}}};

/// Mean of the crossings on the edges.
[[nodiscard]] PointLanes mean_of_crossings(const CrossingLanes& crossings, const GapLanes& gaps);

/// One Newton step from each start.
/// @param lines  those of these cells
[[nodiscard]] std::array<CellPoint, kFour> step_to_surface(const PointLanes& start, const GapLanes& gaps,
                                                           std::span<const LineGaps> lines);

/// A position in lattice steps from the cell's lowest corner, and back: it is then kept 0.03 inside of the cell.
[[nodiscard]] Eigen::Vector3f to_steps(const CellPoint& point);
[[nodiscard]] CellPoint to_cell_point(const Eigen::Vector3f& steps);

/// The direction in which a gap grows at a vertex, of length 1; 0 where it grows nowhere.
[[nodiscard]] Eigen::Vector3f normal_at(const CellPoint& vertex, const Gap& gap);

}  // namespace sonoloft
