#pragma once
// unknown part of a wall -> [LATTICE] -> pieces, each in one triangle of its plane
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/cells/face_polygon.h"

namespace sonoloft {

/// Triangles over a plane: rectangles between lines x = x[i] and y = y[j], halved by their rising diagonal. It is the
/// same for all walls of the plane, so that what is linear over its triangles is continuous from wall to wall.
/// Frame: image, mm.
struct PlaneLattice {
  std::vector<double> x, y;  ///< ascending, 2 and more each

  [[nodiscard]] std::uint32_t node(std::size_t i, std::size_t j) const {
    return static_cast<std::uint32_t>(j * x.size() + i);
  }
  [[nodiscard]] Eigen::Vector2d point(std::uint32_t node) const { return {x[node % x.size()], y[node / x.size()]}; }
};

/// Lines at most `spacing_mm` apart over [low, high], each gap beyond half as wide again as the one before, as far as
/// [from, to]. @pre low <= high, from <= to, spacing_mm > 0
[[nodiscard]] std::vector<double> graded_lines(double low, double high, double from, double to, double spacing_mm);

/// The unknown part of a wall in one triangle.
struct UnknownPiece {
  std::array<std::uint32_t, 3> nodes;                               ///< corners of the triangle, counter-clockwise
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> border;  ///< directed, the unknown part left of it
};

/// @pre the lines reach around the polygon
/// @cost O(#edges * #lines met)
[[nodiscard]] std::vector<UnknownPiece> unknown_pieces(const PlaneLattice& lattice, const FacePolygon& polygon);

}  // namespace sonoloft
