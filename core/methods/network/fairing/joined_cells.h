#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "core/methods/network/contour_surfaces.h"

namespace sonoloft::network {

/// The surfaces of all cells, and where each cell ends. Vertices that lie on no slice stay within their cell: so
/// nothing that is done to them changes what the surfaces are on a slice.
struct JoinedCells {
  ContourSurfaces surfaces;
  std::vector<std::uint32_t> cell_of;                            ///< [#T]
  std::vector<std::vector<Eigen::Hyperplane<double, 3>>> walls;  ///< [#cells] normals into the cell

  [[nodiscard]] bool on_slices(std::uint32_t vertex) const { return vertex < surfaces.on_slices; }
};

}  // namespace sonoloft::network
