#pragma once
// slices -> [ARRANGEMENT] of their planes -> cells, and the contours in their faces
#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/methods/medial_axis/axis/cell_curves.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft::medial {

/// A cell through which surfaces may run.
struct ContourCell {
  std::vector<Facing> faces;
  std::vector<FaceCurve> edges;  ///< ascending by face
};

/// All planes cut all of a box twice the size of the contours, whose walls are outside of everything.
struct Arrangement {
  double scale_mm = 0;            ///< upper bound of coordinates, those of the slices' origins among them
  std::vector<Section> sections;  ///< [#slices]
  std::unique_ptr<PlaneSet> planes{};
  std::unique_ptr<CurveNetwork> network{};
  std::vector<ContourCell> cells{};  ///< those in whose faces there is more than one label
  std::vector<std::string> notes{};
};

/// @error see medial_axis()
[[nodiscard]] Result<Arrangement> arrange(std::span<const TrackedSlice> slices);

}  // namespace sonoloft::medial
