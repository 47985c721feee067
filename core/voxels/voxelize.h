#pragma once
// A mesh as voxels:  mesh -> [VOXELIZE] -> label volume
#include "core/io/volumes/label_volume.h"
#include "core/mesh/mesh.h"
#include "core/slice/result.h"

namespace sonoloft {

/// The label of the space at the centre of every voxel, of cubes that reach around the mesh with one layer of outside
/// on all sides. Centres lie at (n + 1/2) * voxel_mm, so that volumes of one space fit on each other whatever is in it.
/// Exact: a centre has the label whose border the line along x has met an odd number of times before it. Where a mesh
/// runs through itself it is the smallest such label. Frame: the mesh's, mm.
/// @pre   indices in range, threads >= 1
/// @error empty_input, non_finite, invalid_argument (voxel_mm is no length), too_large (over kMaxVolumeSide voxels a
///        side or kMaxVolumeVoxels), bad_contour (a label's border is not closed)
/// @cost  O(#T + crossings + #voxels), 2 bytes a voxel; the result does not depend on `threads`
[[nodiscard]] Result<LabelVolume> voxelize(const IndexedMesh& mesh, double voxel_mm, int threads);

}  // namespace sonoloft
