#pragma once
#include <functional>
#include <vector>

#include "core/methods/stack/plane_grid.h"
#include "core/slice/section.h"

namespace sonoloft {

/// How far the nodes of a grid lie inside of a part of a section: distance to its border in mm, negative outside of it;
/// `nowhere_mm` at all nodes where the section has no such part. Exact to a float within two nodes of a border; farther
/// away the nearest border is found through the neighbours, which on rare nodes is the second nearest.
/// @param is_inside  of a label: whether it belongs to that part
/// @return [#nodes of the grid]
/// @cost   O(#nodes + edges), about 0.1 us a node. Threads: any.
/// Source: Danielsson 1980 (vector distances), to segments.
[[nodiscard]] std::vector<float> signed_distance(const Section& section, const std::function<bool(Label)>& is_inside,
                                                 const PlaneGrid& grid, float nowhere_mm);

}  // namespace sonoloft
