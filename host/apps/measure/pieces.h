#pragma once
// mesh -> [PIECES] -> how many closed surfaces bound its labels, and their handles
#include <cstddef>

#include "core/mesh/mesh.h"

namespace sonoloft {

struct Pieces {
  std::size_t all = 0;    ///< closed surfaces around the labels, hollows among them; of outside none are counted
  std::size_t large = 0;  ///< of these: they enclose at least the given volume
  long genus = 0;         ///< handles of all of them; a number of handles only where they are closed manifolds
};

/// Triangles belong together where they share a vertex and bound the same label. Sums over all labels.
/// @pre   indices in range; vertices are shared (not repeated for every triangle)
/// @cost  O(#labels (#V + #T))
[[nodiscard]] Pieces count_pieces(const IndexedMesh& mesh, double large_mm3);

}  // namespace sonoloft
