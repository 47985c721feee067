#pragma once
// Beside the stages:  mesh, samples, background -> [COVERAGE] -> what of the mesh was seen
#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/background/background.h"
#include "core/octree/brick.h"

namespace sonoloft {

/// How sure points of a surface are. For a physician: `measured` 1 means that the surface was drawn here from what the
/// probe showed on all sides, 0 that all of it was made up from farther away; `distance_mm` is how far the nearest
/// place is that the probe really showed.
struct Confidence {
  std::vector<float> measured;     ///< [#P] 0..1: share of the field here that slices had, the rest is background;
                                   ///< trilinear between the samples around the point
  std::vector<float> distance_mm;  ///< [#P] to the nearest known part of a slice, off by at most 1.2 spacings of the
                                   ///< background; farther than 8 of them is not told apart
};

/// @param points_mm  vertices of a mesh drawn from `samples`, reference frame
/// @cost  O(#P): 1.3 us each for the vertices of a joined mesh, 2.6 us chunk by chunk, since the distance is worked out
///        block by block. Threads: any, but not during an update of samples or background.
[[nodiscard]] Confidence confidence_at(std::span<const Eigen::Vector3f> points_mm, const SampleLattice& samples,
                                       const Background& background);

}  // namespace sonoloft
