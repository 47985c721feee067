#pragma once
#include "core/methods/network/fairing/joined_cells.h"

namespace sonoloft::network {

/// Makes the surfaces smooth: vertices on slices stay, the others go where the bi-Laplacian of all positions vanishes,
/// in the sense of least squares, through the contours as well; but never through a wall of their cell.
/// @return whether the equations could be solved; else nothing has changed
/// @cost  a sparse factorisation: about 20 us a vertex
/// Source: Botsch, Kobbelt 2004, An intuitive framework for real-time freeform modeling, section 3 (with equal
/// weights).
[[nodiscard]] bool fair(JoinedCells& cells);

}  // namespace sonoloft::network
