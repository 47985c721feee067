#pragma once
#include <cstddef>
#include <vector>

#include "core/kernels/layout.h"

namespace sonoloft {

/// Appends what stands for the chain vertices[first...] from afar, so that a point pays for the contours near it and
/// not for how finely far ones are drawn: the whole chain, its halves, their halves... Two edges stand for a stretch;
/// the vertex between them keeps the area between the stretch and its chord and, to first order, how that area grows as
/// the vertices move outward. A stretch that turns back on itself never has one. Short chains get none.
/// @param vertices  in units of the cell's size; the chain ends with the last one
/// @cost  O(#chain log #chain)
/// Source: the contour tree of docs/pipeline/4-field.md.
void add_stretches(const std::vector<kernels::PackedVertex>& vertices, std::size_t first,
                   std::vector<kernels::PackedStretch>& stretches);

}  // namespace sonoloft
