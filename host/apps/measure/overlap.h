#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "core/voxels/line_scan.h"
#include "host/apps/measure/measure.h"

namespace sonoloft {

/// The scan lines: parallel to x through every (y, z). `x` gives the voxel centres along a line when the truth is
/// voxels; with x.count == 0 lengths are continuous.
struct ScanLines {
  Ticks x, y, z;
};

struct Overlap {
  std::vector<LabelOverlap> labels;  ///< ascending
  std::size_t open_lines;
};

/// @pre the lines reach around both meshes; `truth_voxels` or `truth_mesh` is given, of the voxels the first one lies
/// at
///      tick `voxel_offset` of the lines
struct OverlapInput {
  const IndexedMesh& mesh;
  const IndexedMesh* truth_mesh;
  const LabelVolume* truth_voxels;
  std::array<std::size_t, 3> voxel_offset;
};

/// Threads: any number; the sums are taken in a fixed order.
[[nodiscard]] Overlap scan_overlap(const OverlapInput& input, const ScanLines& lines, int threads);

}  // namespace sonoloft
