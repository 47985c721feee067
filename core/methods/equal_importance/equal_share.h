#pragma once
#include <vector>

#include "core/methods/stack/plane_grid.h"

namespace sonoloft {

/// A node's share of the way between two contours.
struct Share {
  float way;     ///< 0 on the lower contour, 1 on the upper one
  float per_mm;  ///< the size of its gradient; 0 where the node lies between no two contours
};

/// Shares between two contours whose gradient keeps its size along the way from one to the other (infinity-harmonic):
/// so every stretch of a way counts the same. For nodes inside of just one of two slices; all others are 0.
/// @param lower_mm, upper_mm  [#nodes] signed distances
/// @cost  about 1 us a node of these and sweep, 40 to 400 sweeps
/// Source: Cong, Parvin 2001, the regularised form; Oberman 2005 (the scheme: no neighbours differ more in either
/// direction than they must).
[[nodiscard]] std::vector<Share> equal_shares(const PlaneGrid& grid, const std::vector<float>& lower_mm,
                                              const std::vector<float>& upper_mm);

}  // namespace sonoloft
