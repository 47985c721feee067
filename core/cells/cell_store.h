#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/cells/exact/polyhedron.h"

namespace sonoloft {

inline constexpr std::uint32_t kBoxWalls = 6;
inline constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// A node of the tree of planes; a negative child is the leaf of cell ~child.
struct TreeNode {
  std::uint32_t plane;
  std::int32_t child[2];  ///< below, above
};

struct Cell {
  Polyhedron shape;                       ///< PolyFace::polygon is the index of its Wall; without faces: no cell more
  std::uint32_t node = kNone;             ///< of the tree, under which this cell hangs; kNone: it is the root ...
  std::uint8_t branch = 0;                ///< ... on this side
  Label label = kBeyondFace;              ///< of all its walls, when they have one known label between them
  std::vector<std::uint32_t> remembered;  ///< planes of slices that say `label` all over this cell: see SliceCut
};

/// The part of a slice that lies in a cell.
struct Arrival {
  CellId cell;
  FacePolygon polygon;
};

/// The labels of a face. Both cells at a wall refer to one polygon until one of them is cut there and the other is not.
struct Wall {
  FacePolygon polygon;
  Label label = kBeyondFace;
  std::uint32_t users = 0;
};

/// A slice that was inserted.
struct HeldSlice {
  Section section;
  std::uint32_t plane = kNone;  ///< kNone: it has cut nothing, and nothing remembers it
  bool withdrawn = false;
};

/// All that a CellComplex keeps.
struct CellStore {
  Eigen::AlignedBox3d box;
  double min_gap_mm;
  double scale;  ///< upper bound of coordinates, for rounding bounds
  std::vector<HeldSlice> slices;
  std::vector<Plane> planes;                ///< [#planes] the first kBoxWalls are those of the box
  std::vector<Eigen::Isometry3d> frames;    ///< [#planes]
  std::vector<std::uint32_t> plane_slices;  ///< [#planes] kNone for those of the box
  std::vector<TreeNode> nodes;
  std::int32_t root = ~0;
  std::vector<Cell> cells;
  std::size_t removed_cells = 0;
  std::vector<Wall> walls;
  std::vector<std::uint32_t> free_walls;
  std::vector<std::uint32_t> released_walls;  ///< by the insertion that runs: its cuts may still hand them on

  CellStore(const Eigen::AlignedBox3d& box_mm, double gap_mm);

  /// See CellComplex.
  [[nodiscard]] Result<CellComplex::Delta> insert(Section section, const CellComplex::PartWidth& width);
  /// Cuts the cells that parts of a slice have reached.
  void cut(std::uint32_t slice, std::vector<Arrival> reached, const CellComplex::PartWidth& width,
           CellComplex::Delta& delta);
  /// The labels of a wall of the box: outside.
  [[nodiscard]] FacePolygon box_wall(std::uint32_t wall) const;
  std::uint32_t add_wall(FacePolygon polygon, std::uint32_t users);
  void release_wall(std::uint32_t wall);
  void recycle_walls();
  [[nodiscard]] Label label_of(const Polyhedron& shape) const;  ///< see Cell::label

  /// The place in the tree on one side of a node; of the root: node kNone.
  [[nodiscard]] std::int32_t& child(std::uint32_t node, std::uint8_t branch) {
    return node == kNone ? root : nodes[node].child[branch];
  }
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
