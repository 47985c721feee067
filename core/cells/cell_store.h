#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/cells/exact/polyhedron.h"

namespace sonoloft {

/// A node of the tree of planes; a negative child is the leaf of cell ~child.
struct TreeNode {
  std::uint32_t plane;
  std::int32_t child[2];  ///< below, above
};

struct Cell {
  Polyhedron shape;                       ///< PolyFace::polygon is the index of its Wall
  std::uint32_t node;                     ///< of the tree, under which this cell hangs ...
  std::uint8_t branch;                    ///< ... on this side; both meaningless for the only cell of an uncut box
  Label label = kBeyondFace;              ///< of all its walls, when they have one known label between them
  std::vector<std::uint32_t> remembered;  ///< planes of slices that say `label` all over this cell: see SliceCut
};

/// The labels of a face. Both cells at a wall refer to one polygon until one of them is cut there and the other is not.
struct Wall {
  FacePolygon polygon;
  Label label = kBeyondFace;
  std::uint32_t users = 0;
};

inline constexpr std::uint32_t kBoxWalls = 6;

/// All that a CellComplex keeps.
struct CellStore {
  Eigen::AlignedBox3d box;
  double min_gap_mm;
  double scale;                           ///< upper bound of coordinates, for rounding bounds
  std::vector<Plane> planes;              ///< [#planes] the first kBoxWalls are those of the box
  std::vector<Eigen::Isometry3d> frames;  ///< [#planes]
  std::vector<TreeNode> nodes;
  std::vector<Cell> cells;
  std::vector<Wall> walls;
  std::vector<std::uint32_t> free_walls;
  std::vector<std::uint32_t> released_walls;  ///< by the insertion that runs: its cuts may still hand them on

  CellStore(const Eigen::AlignedBox3d& box_mm, double gap_mm);

  [[nodiscard]] Result<CellComplex::Delta> insert(const Section& section);  ///< see CellComplex
  std::uint32_t add_wall(FacePolygon polygon, std::uint32_t users);
  void release_wall(std::uint32_t wall);
  void recycle_walls();
  [[nodiscard]] Label label_of(const Polyhedron& shape) const;  ///< see Cell::label

  [[nodiscard]] std::int32_t root() const { return nodes.empty() ? ~0 : 0; }
  [[nodiscard]] CellId locate(const Eigen::Vector3d& point_mm) const;
  /// Where a plane meets the plane of a frame, in that frame's image; false when they are parallel: then line.offset_mm
  /// is the distance of the frame's origin from the plane.
  [[nodiscard]] bool line_on(std::uint32_t plane, const Eigen::Isometry3d& frame, ImageLine& line) const;
};

/// The label of a polygon without borders inside, else kBeyondFace.
[[nodiscard]] Label uniform_label(const FacePolygon& polygon);

/// A rectangle of one label, counter-clockwise.
[[nodiscard]] FacePolygon rectangle(const Eigen::AlignedBox2d& r, Label label);

/// See CellComplex::validate().
[[nodiscard]] std::string validate(const CellStore& store);

}  // namespace sonoloft
