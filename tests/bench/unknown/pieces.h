#pragma once
// Mesh, slices -> [PIECES] -> closed surfaces, and those that nothing measured speaks for
#include <cstddef>
#include <span>

#include "core/mesh/mesh.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft::bench {

struct Pieces {
  std::size_t all = 0;       ///< closed surfaces around all labels but outside, hollows among them
  std::size_t spurious = 0;  ///< of these: no known pixel of what is inside lies as near to this piece as to any other
};

/// @param pixel_mm  of the slices; how far from a vertex pixels are looked at is 3 of them
/// @pre   the labels' surfaces are closed
[[nodiscard]] Pieces count_pieces(const IndexedMesh& mesh, std::span<const TrackedSlice> slices, double pixel_mm);

}  // namespace sonoloft::bench
