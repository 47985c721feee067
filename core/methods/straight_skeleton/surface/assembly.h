#pragma once
#include <span>

#include "core/methods/network/fairing/joined_cells.h"
#include "core/methods/straight_skeleton/space/facet.h"

namespace sonoloft::skeleton {

struct Assembly {
  network::JoinedCells cells;
  std::vector<const Facet*> used;  ///< facets that triangles are of
};

/// Makes triangles of facets that tell labels apart. Lines have exact names: each edge is cut at every vertex of its
/// line, whichever facet has it, so that what closes in space closes in the mesh.
/// @cost about 20 us a vertex
[[nodiscard]] Assembly assemble(const Space& space, std::span<const Facet> facets, int threads);

}  // namespace sonoloft::skeleton
