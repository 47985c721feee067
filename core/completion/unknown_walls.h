#pragma once
// cells -> [UNKNOWN WALLS] -> what is to be completed, and what is known around it
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/completion/corner_values.h"
#include "core/completion/plane_lattice.h"

namespace sonoloft {

/// A slice's plane with unknown parts.
struct UnknownPlane {
  Eigen::Isometry3d frame;
  const Section* section = nullptr;
  Eigen::AlignedBox2d bounds;  ///< of its walls with unknown parts
  PlaneLattice lattice;
  std::vector<std::uint32_t> corners;  ///< nodes of triangles with unknown parts, ascending
};

/// A wall with unknown parts, of one cell or of both beside it.
struct UnknownWall {
  PlaneId plane;
  const FacePolygon* polygon;
  std::vector<UnknownPiece> pieces;
};

/// The walls of a complex, those with unknown parts cut along triangles. Valid while the complex does not change.
struct UnknownWalls {
  const CellComplex& cells;
  double spacing_mm;                              ///< of the triangles where materials are
  std::vector<Label> labels;                      ///< ascending, all of the slices, outside always first
  std::vector<std::vector<SeenWall>> cell_walls;  ///< [cell]
  std::map<PlaneId, UnknownPlane> planes;
  std::vector<UnknownWall> walls;
  std::vector<std::vector<std::uint32_t>> walls_of_cell;  ///< [cell] in `walls`

  UnknownWalls(const CellComplex& complex, double spacing, int threads);

  /// The cells below and above a point of a plane.
  [[nodiscard]] std::pair<CellId, CellId> beside(const Eigen::Isometry3d& frame, const Eigen::Vector2d& point) const;

 private:
  void look_at_walls();
  [[nodiscard]] CellId behind(const CellFace& face) const;
  void lay_lattices();
  void cut_pieces(int threads);
};

/// A point of a plane's image in reference.
[[nodiscard]] inline Eigen::Vector3d on_plane(const Eigen::Isometry3d& frame, const Eigen::Vector2d& p) {
  return frame * Eigen::Vector3d(p.x(), p.y(), 0);
}

}  // namespace sonoloft
