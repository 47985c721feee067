#pragma once
#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"

namespace sonoloft::bench {

/// Where labels change between smoothed samples, shares interpolated trilinearly, as seen from the triangles of a mesh.
struct ZeroSet {
  std::vector<Eigen::Vector3d> points_mm;  ///< on it
  std::vector<double> distances_mm;        ///< of corners and centres of triangles from it along their normals
  std::vector<Eigen::Vector3d> missed_mm;  ///< of these, where nothing lies within a finest cell: none of the above
};

/// @param live  the mesh that was drawn from `samples`
[[nodiscard]] ZeroSet zero_set(const SampleLattice& samples, const MeshSnapshot& live, const IndexedMesh& mesh);

}  // namespace sonoloft::bench
