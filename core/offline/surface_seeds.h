#pragma once
#include <Eigen/Core>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/offline/label_oracle.h"

namespace sonoloft {

/// A point on the surface between two labels. Lattice steps.
struct SurfaceSeed {
  Eigen::Vector3d point;
  Label lower, upper;  ///< lower < upper
};

/// Points on every connected piece of every interface of the live mesh, where lattice edges cross it: one in every cube
/// of edge `distance`, all on small pieces. Lengths in lattice steps.
[[nodiscard]] std::vector<SurfaceSeed> surface_seeds(const IndexedMesh& live_in_steps, const LabelOracle& oracle,
                                                     double distance, double tolerance);

/// The same where the live mesh has a vertex and the refined one has none within a step in each axis: all crossings.
[[nodiscard]] std::vector<SurfaceSeed> missed_seeds(const IndexedMesh& live_in_steps,
                                                    const IndexedMesh& refined_in_steps, const LabelOracle& oracle,
                                                    double tolerance);

}  // namespace sonoloft
