#pragma once
#include "core/methods/network/fairing/joined_cells.h"

namespace sonoloft::network {

/// Divides triangles until they are as dense everywhere as the contours, and turns edges between triangles of one pair
/// of labels that are no creases until they are Delaunay. Contours stay as they are, and no new edge lies on a slice.
/// @param growth  by how much edges become longer on the way from the contours; 0: not at all, as in the source
/// @cost  O(#T log #T) a round
/// Source: Liepa 2003, Filling holes in meshes, section 3, with the factor of Liu et al. 2008, section 5.
void refine(JoinedCells& cells, double growth);

}  // namespace sonoloft::network
