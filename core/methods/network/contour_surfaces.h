#pragma once
// contours -> medial axis or straight skeleton -> [SURFACES] -> mesh
#include <array>
#include <vector>

#include "core/methods/method.h"

namespace sonoloft {

/// A closed surface network that runs through the contours exactly. Frame: reference, mm.
struct ContourSurfaces {
  std::vector<Eigen::Vector3d> positions;               ///< [#V] mm
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [#T]
  std::vector<Label> label_front;                       ///< [#T] the side the normal points to; 0 = outside
  std::vector<Label> label_back;                        ///< [#T] never equal to label_front
  std::size_t on_slices = 0;                            ///< vertices below this lie on slices, all others between them
  std::vector<std::string> notes;                       ///< see MethodSurfaces
};

[[nodiscard]] MethodSurfaces as_mesh(ContourSurfaces surfaces);

}  // namespace sonoloft
