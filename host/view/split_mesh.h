#pragma once
// mesh of a file -> [SPLIT MESH] -> chunks, as a scan has them
#include "core/mesh/mesh.h"

namespace sonoloft::view {

/// The mesh in chunks of some thousand triangles that lie together. A triangle belongs to the chunk of its first
/// corner.
/// @pre  indices in range @post the chunks hold the triangles of the mesh, each once; vertex keys are its indices
[[nodiscard]] MeshSnapshot split(const IndexedMesh& mesh);

}  // namespace sonoloft::view
