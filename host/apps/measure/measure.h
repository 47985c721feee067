#pragma once
// How good is a surface?  mesh + truth -> [MEASURE] -> one number per label and question
#include <cstddef>
#include <vector>

#include "core/io/volumes/label_volume.h"
#include "core/mesh/mesh.h"
#include "core/slice/label.h"
#include "core/slice/result.h"

namespace sonoloft {

/// What a label's space has in common in a mesh and in the truth.
struct LabelOverlap {
  Label label;
  double mesh_mm3;
  double truth_mm3;
  double common_mm3;
  [[nodiscard]] double iou() const { return common_mm3 / (mesh_mm3 + truth_mm3 - common_mm3); }
  [[nodiscard]] double dice() const { return 2.0 * common_mm3 / (mesh_mm3 + truth_mm3); }
};

/// How far two surfaces are apart, seen from both sides. Mean: of the two one-sided means, each over the area of its
/// surface; maximum: the larger of the two one-sided ones. Infinite where only one of the surfaces exists.
struct SurfaceDistance {
  double mean_mm;
  double max_mm;
};

struct LabelDistance {
  Label label;
  SurfaceDistance distance;  ///< between what bounds this label in the mesh and what bounds it in the truth
};

/// Labels that occur on neither side are not listed, nor is the outside.
struct Comparison {
  std::vector<LabelOverlap> overlaps;    ///< ascending by label
  std::vector<LabelDistance> distances;  ///< the same labels in the same order
  SurfaceDistance surface;               ///< all triangles together, whatever they separate
  double truth_diagonal_mm;  ///< of the bounding box of the truth's surface; distances are often given over it
  std::size_t open_lines;    ///< scan lines that met a label's border an odd number of times: 0 if all closes
};

/// Compares with a true mesh. Space is scanned along x by 512 lines across the longer of the two other sides of both
/// meshes' common box; lengths along a line are exact. A label's space is where a line has met its border an odd number
/// of times; a line through a vertex or an edge counts it once for a closed mesh, by one rule for all triangles.
/// Distances are taken at 100,000 points spread evenly over each surface, the maximum at all vertices too.
/// Frame: both in the same one, mm.
/// @pre   indices are in range, threads >= 1
/// @error empty_input (no triangle in either), non_finite, too_large (over 2^20 lines a side)
/// @cost  seconds for 300,000 triangles; the result does not depend on `threads`
[[nodiscard]] Result<Comparison> measure_against_mesh(const IndexedMesh& mesh, const IndexedMesh& truth, int threads);

/// Compares with true voxels. Overlaps count voxel centres, those of the volume's grid continued without end (all
/// outside) where the mesh is larger. The truth's surface are the faces between voxels of different labels: its steps
/// alone make the mean distance about a quarter of a voxel.
/// @error as above; also invalid_argument (a volume whose sizes do not agree or that has no spacing)
[[nodiscard]] Result<Comparison> measure_against_volume(const IndexedMesh& mesh, const LabelVolume& truth, int threads);

/// The faces between voxels of different labels as a mesh, voxels beyond the volume counted as outside.
/// @pre  dims fit the number of labels
/// @cost O(#voxels)
[[nodiscard]] IndexedMesh voxel_surface(const LabelVolume& volume);

}  // namespace sonoloft
