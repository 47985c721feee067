#pragma once
// Stage 1 of 5:  slice -> [CELLS] -> field -> octree -> mesh -> callback
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/cells/face_polygon.h"
#include "core/slice/label.h"
#include "core/slice/result.h"
#include "core/slice/section.h"

namespace sonoloft {

enum class CellId : std::uint32_t {};   ///< dense, never reused
enum class PlaneId : std::uint32_t {};  ///< 0..5 are the walls of the box, then the slices in the order of insertion

struct CellStore;

/// A face of a cell as that cell sees it. Valid until the next insert().
struct CellFace {
  const Eigen::Isometry3d* image_to_reference;  ///< frame of the plane: x, y in the plane, z its normal
  PlaneId plane;
  bool above;                  ///< the cell lies on the side that the normal points to
  Label label;                 ///< the one label of the whole face, or kBeyondFace when it has several
  const FacePolygon* polygon;  ///< never null; may be empty for a sliver
};

/// The points that lie in one cell: order[first, first + count) of CellComplex::locate().
struct CellPoints {
  CellId cell;
  std::uint32_t first, count;
};

/// The convex cells that the planes of the slices inserted so far cut out of a box. The box's walls are labelled
/// outside. Which vertices lie on which side of a plane is decided exactly (planes are taken as their double
/// coefficients), so every sequence of planes gives valid polyhedra; coordinates are doubles. Frame: reference, mm.
/// Threads: one writer; const members may run together, but not during insert(). Source: Bermano, Vaxman, Gotsman 2011,
/// section 4.2.
class CellComplex {
 public:
  /// What one insert() had to look at: it does not grow with slices whose cells it does not reach, but for the way
  /// through the tree.
  struct Work {
    std::uint32_t nodes_visited = 0;  ///< of the tree of planes
    std::uint32_t faces_cut = 0;      ///< walls between cells that were split; a wall of two cells counts once
    std::uint32_t edges_clipped = 0;  ///< label borders and outline pieces: of the slice on its way, and of those walls
  };

  /// What one insert() changed.
  struct Delta {
    PlaneId plane{};
    std::vector<CellId> divided;  ///< cells of before that are now several, ascending: their field must be computed
                                  ///< again; each keeps its id for one of its parts
    std::vector<CellId> lower;    ///< [k] cells below the slice's walls
    std::vector<CellId> upper;    ///< [k] cells above them, all new; upper[i] was cut off lower[i]
    std::uint32_t reached = 0;    ///< cells that the known part of the slice reaches
    Work work;
  };

  /// @param min_gap_mm  a cell is cut only if both parts reach at least this far from the plane: near-coincident slices
  ///                    merge into the first instead of leaving slivers; > 0
  CellComplex(const Eigen::AlignedBox3d& box, double min_gap_mm);
  ~CellComplex();
  CellComplex(CellComplex&&) noexcept;
  CellComplex& operator=(CellComplex&&) noexcept;

  /// Cuts every cell that the known part of `section` reaches, except where all of a cell is of one label and the slice
  /// says nothing else there: such a cell is cut once a later slice does, as if it had been cut at once.
  /// @post  cell_count() grew by upper.size(); views taken before are invalid
  /// @error outside_box (no known part in the box), cell_limit, duplicate_plane (reached cells, but cut none):
  ///        nothing has changed
  /// @cost  O(tree nodes and cells crossed, contour edges in them); allocates
  [[nodiscard]] Result<Delta> insert(const Section& section);

  [[nodiscard]] std::size_t cell_count() const;
  [[nodiscard]] std::size_t face_count() const;  ///< a wall between two cells counts once
  [[nodiscard]] std::size_t edge_count() const;  ///< label borders and outline pieces on all faces: what the field sums
  [[nodiscard]] const Eigen::AlignedBox3d& box() const;

  /// The faces of a cell in the order in which they came to be (box walls first).
  void faces(CellId cell, std::vector<CellFace>& out) const;
  [[nodiscard]] Eigen::AlignedBox3d bounds(CellId cell) const;
  [[nodiscard]] Eigen::Vector3d centre(CellId cell) const;  ///< mean of the vertices, inside
  [[nodiscard]] double volume(CellId cell) const;           ///< mm^3

  /// The cell of a point; a point on a plane belongs to the side the normal points to. Points outside of the box
  /// belong to a cell at the wall. O(depth of the tree)
  [[nodiscard]] CellId locate(const Eigen::Vector3d& point_mm) const;
  /// The same for many points that lie in `bounds`, which prunes the tree.
  /// @param order   out, [#P] indices of points_mm, those of one cell together
  /// @param groups  out, one for each cell with points: where in `order` they are
  /// @cost  O(#P log #planes); allocates only when the outputs grow
  void locate(const Eigen::AlignedBox3d& bounds, std::span<const Eigen::Vector3d> points_mm,
              std::vector<std::uint32_t>& order, std::vector<CellPoints>& groups) const;

  /// Empty when the complex is sound, else what is wrong: Euler's formula per cell, two faces at every edge, vertices
  /// on the planes of their faces and within all others, the tree leading to the cell; over all cells, a cell on both
  /// sides of every wall and volumes that add up to the box, to 10^-9 or what rounding of coordinates leaves.
  /// O(all); for tests.
  [[nodiscard]] std::string validate() const;

 private:
  std::unique_ptr<CellStore> store_;
};

}  // namespace sonoloft
