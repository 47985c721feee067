#pragma once
// What the labels amount to:  core/mesh -> [STATISTICS] -> MeshUpdate
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"
#include "core/slice/label.h"

namespace sonoloft {

struct LabelStatistics {
  Label label;            ///< a material, never outside
  std::size_t triangles;  ///< that bound it, on either side
  double volume_ml;       ///< of its space
};

/// Keeps the statistics of a mesh that changes chunk by chunk. Threads: one at a time.
class LabelStatisticsKeeper {
 public:
  /// @param centre_mm  volumes are summed as seen from here: choose a point near the mesh, for the digits' sake
  explicit LabelStatisticsKeeper(const Eigen::Vector3d& centre_mm) : centre_mm_(centre_mm) {}

  /// The statistics of `mesh`, ascending by label; labels without a triangle are not listed.
  /// @param changed  the chunks in which `mesh` differs from that of the call before; ascending
  /// @post  depends on `mesh` alone
  /// @cost  O(triangles of changed chunks + all chunks)
  /// Source: divergence theorem; a volume is the sum of signed tetrahedra over the triangles around it.
  [[nodiscard]] std::vector<LabelStatistics> update(const MeshSnapshot& mesh, std::span<const BrickCoord> changed);

 private:
  Eigen::Vector3d centre_mm_;
  std::unordered_map<BrickCoord, std::vector<LabelStatistics>, BrickCoordHash> parts_;  ///< by chunk
};

}  // namespace sonoloft
