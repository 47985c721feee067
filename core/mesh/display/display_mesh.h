#pragma once
// mesh -> [DISPLAY] -> a mesh for the eye alone
#include <cstddef>

#include "core/mesh/mesh.h"

namespace sonoloft {

/// A mesh to look at: fewer triangles, and none of the promises of the one it was made from. Triangles may be thin,
/// may cross, and edges may have more than two of them. To measure, export or compare, take the original.
struct DisplayMesh {
  IndexedMesh mesh;  ///< its vertices are vertices of the original, bit for bit
  double error_mm;   ///< about how far the original is from it, at most
};

/// Simplifies the surface between every two labels by itself, all to the same share. Lines where surfaces of different
/// labels meet, or the mesh ends, stay as they are, so that the surfaces still fit together there; no surface between
/// two labels vanishes whole.
/// @param triangles  about as many are left; more where lines and small pieces keep theirs
/// @cost  O(#T log #T); some 60 ms for 100,000 triangles
/// Source: Garland, Heckbert 1997 (quadric error), as meshoptimizer has it.
[[nodiscard]] DisplayMesh simplify_for_display(const IndexedMesh& mesh, std::size_t triangles);

}  // namespace sonoloft
