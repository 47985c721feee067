#pragma once
#include <Eigen/Core>

#include "core/mesh/mesh.h"

namespace sonoloft::test {

/// A sphere of 20 * 4^levels triangles with its vertices on the sphere; `back` is the label inside.
[[nodiscard]] IndexedMesh sphere_mesh(const Eigen::Vector3d& center_mm, double radius_mm, int levels, Label front = 0,
                                      Label back = 1);

/// The 12 triangles of a box; `back` is the label inside.
[[nodiscard]] IndexedMesh box_mesh(const Eigen::Vector3d& low_mm, const Eigen::Vector3d& high_mm, Label front = 0,
                                   Label back = 1);

/// A square of 2 triangles across z, its normal along +z.
[[nodiscard]] IndexedMesh square_mesh(const Eigen::Vector3d& center_mm, double side_mm, Label front = 0,
                                      Label back = 1);

/// Both meshes in one, nothing joined.
[[nodiscard]] IndexedMesh together(IndexedMesh one, const IndexedMesh& other);

}  // namespace sonoloft::test
