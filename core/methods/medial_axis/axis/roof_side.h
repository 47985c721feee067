#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/methods/medial_axis/axis/cell_axis.h"

namespace sonoloft::medial {

/// A ridge as a face sees it.
struct RoofSide {
  std::uint32_t ridge;
  Point p, q;
  Eigen::AlignedBox2d box;  ///< around it, with a margin for rounding
};

/// @param margin_mm  of the box
[[nodiscard]] RoofSide roof_side(const CellAxis& axis, std::uint32_t ridge, std::uint32_t face, double margin_mm);

/// All ridges over a face that are no edges of the cell, ascending.
[[nodiscard]] std::vector<RoofSide> roof_sides(const CellAxis& axis, std::uint32_t face, double margin_mm);

}  // namespace sonoloft::medial
