#pragma once
// Beside the stages:  mesh, samples, background -> [COVERAGE] -> what of the mesh was seen
#include <Eigen/Core>
#include <vector>

#include "core/background/background.h"
#include "core/mesh/mesh.h"
#include "core/octree/brick.h"

namespace sonoloft {

/// How sure the vertices of one chunk are. For a physician: `measured` 1 means that the surface was drawn here from
/// what the probe showed on all sides, 0 that all of it was made up from farther away; `distance_mm` is how far the
/// nearest place is that the probe really showed.
struct ChunkConfidence {
  std::vector<float> measured;     ///< [#V] 0..1: share of the field here that slices had, the rest is background;
                                   ///< trilinear between the samples around the vertex
  std::vector<float> distance_mm;  ///< [#V] to the nearest known part of a slice, off by at most 1.2 spacings of the
                                   ///< background; farther than 8 of them is not told apart
};

/// @param samples     what the chunk was drawn from, not updated since
/// @cost  O(#V), about 0.2 us a vertex. Threads: any, but not during an update of samples or background.
[[nodiscard]] ChunkConfidence confidence_of(const MeshChunk& chunk, const SampleLattice& samples,
                                            const Background& background);

}  // namespace sonoloft
