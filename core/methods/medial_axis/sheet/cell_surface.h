#pragma once
// the curves of a cell -> [SURFACE] -> triangles between two labels
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/medial_axis/axis/cell_curves.h"

namespace sonoloft::medial {

/// A triangle of a surface network; its normal (counter-clockwise) points to `front`.
struct LabelledTriangle {
  std::array<std::uint32_t, 3> corners;
  Label front, back;
};

/// What a cell has of the surfaces. Every point of the cell has the label that the face nearest to it has at its foot;
/// where two labels meet there are triangles: in sheets, and in walls on the contours.
struct CellSurface {
  std::vector<CurveVertex> vertices;
  std::vector<LabelledTriangle> triangles;
};

/// @param faces  of the cell @param edges  pieces of contours in its faces, ascending by face
/// @cost  O((#edges + #meetings) log #edges), and #edges^2 quick tests a sheet
[[nodiscard]] CellSurface surface_of_cell(const CurveNetwork& network, std::span<const Facing> faces,
                                          std::span<const FaceCurve> edges, double scale_mm);

}  // namespace sonoloft::medial
