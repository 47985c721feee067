#pragma once
// Stage 1 of 5:  slice -> [CELLS] -> field -> octree -> mesh -> callback
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/cells/face_polygon.h"
#include "core/slice/label.h"
#include "core/slice/result.h"
#include "core/slice/section.h"

namespace sonoloft {

enum class CellId : std::uint32_t {};   ///< dense, never reused
enum class PlaneId : std::uint32_t {};  ///< 0..5 are the walls of the box, then slices that cut cells
enum class SliceId : std::uint32_t {};  ///< 0, 1, ... in the order of insertion

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

/// Points in a row: first + i * step. Frame: reference, mm.
struct PointRow {
  Eigen::Vector3d first, step;
};

/// The points begin <= i < end of a row.
struct RowPiece {
  std::uint32_t row, begin, end;
};

/// The row pieces that lie in one cell: pieces[first, first + count) of CellComplex::locate_rows().
struct CellPieces {
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
    SliceId slice{};
    PlaneId plane{};              ///< meaningless when no cell was cut
    std::vector<CellId> divided;  ///< cells of before that are now several, ascending: their field must be computed
                                  ///< again; each keeps its id for one of its parts
    std::vector<CellId> lower;    ///< [k] cells below the slice's walls
    std::vector<CellId> upper;    ///< [k] cells above them, all new; upper[i] was cut off lower[i]
    std::uint32_t reached = 0;    ///< cells that the known part of the slice reaches
    std::uint32_t too_thin = 0;   ///< of those to be cut, left whole since a part would have been too thin
    Work work;
  };

  /// What withdraw() changed, and where the slices that stay must be inserted again.
  struct Withdrawal {
    /// A place in the tree of planes.
    struct Region {
      struct Step {
        std::uint32_t plane;
        std::uint8_t branch;
      };
      std::vector<Step> path;  ///< from the root
      std::uint32_t parent;    ///< node under which the region hangs; meaningless when the path is empty
      CellId restored;         ///< the cell that the slice had cut first, whole again
    };
    std::vector<CellId> removed;  ///< cells that are no more, ascending: their field must be computed again
    std::vector<SliceId> slices;  ///< of which walls are no more, ascending: itself and those that cut there later
    std::vector<Region> regions;
    Work work;  ///< its edges clipped: of what labels the walls of the cells made whole
  };

  /// @param min_gap_mm  a cell is cut only if both parts reach at least this far from the plane: of near-coincident
  ///                    slices the first keeps the wall, no slivers; > 0
  CellComplex(const Eigen::AlignedBox3d& box, double min_gap_mm);
  ~CellComplex();
  CellComplex(CellComplex&&) noexcept;
  CellComplex& operator=(CellComplex&&) noexcept;

  /// How far both parts of a cell must reach from the plane that cuts it, mm: raised to min_gap_mm; infinity leaves the
  /// cell whole.
  using PartWidth = std::function<double(CellId)>;
  static double anywhere(CellId) { return 0; }

  /// Cuts cells that the known part of `section` reaches, where `width` lets it. Where all of a
  /// cell is of one label and the slice says nothing else there, it is cut once a later slice does, as if it had been
  /// cut at once.
  /// @post  cell_count() grew by upper.size(); views taken before are invalid
  /// @error outside_box (no known part in the box), cell_limit: nothing has changed
  /// @cost  O(tree nodes and cells crossed, contour edges in them); allocates
  [[nodiscard]] Result<Delta> insert(Section section, const PartWidth& width = anywhere);

  /// Makes whole again what a slice has cut, the cuts of later slices there included: call insert_again() for every
  /// slice held, in their order.
  /// @pre  the slice is held
  /// @cost O(tree nodes + cells, + per region the length of its path and the edges of the slices at its walls)
  [[nodiscard]] Withdrawal withdraw(SliceId slice);
  /// The same as insert() for a slice that is held, within the regions of a withdrawal.
  [[nodiscard]] Delta insert_again(SliceId slice, const Withdrawal& where, const PartWidth& width = anywhere);

  /// The slices inserted and not withdrawn, those that cut nothing among them, ascending.
  [[nodiscard]] std::vector<SliceId> slices() const;
  [[nodiscard]] const Section& section(SliceId slice) const;           ///< valid until the next insert()
  [[nodiscard]] std::optional<SliceId> slice_of(PlaneId plane) const;  ///< none: a wall of the box

  [[nodiscard]] std::size_t cell_count() const;
  [[nodiscard]] std::size_t cell_bound() const;  ///< ids are below this; those of cells that are no more among them
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
  /// The same for points in rows; those within rounding of a plane may be taken to either side of it.
  /// @param pieces  in: which points, none empty; out: they, those of one cell together
  /// @param groups  out, one for each cell with points: where in `pieces` they are
  /// @cost  O(rows * planes met on the way); allocates
  void locate_rows(std::span<const PointRow> rows, std::vector<RowPiece>& pieces,
                   std::vector<CellPieces>& groups) const;

  /// The cells that a segment touches, those at whose walls it lies among them: a superset by rounding.
  /// @param out  appended to, in the order of the tree, each cell once
  /// @cost  O(depth of the tree * cells touched)
  void touching(const Eigen::Vector3d& a_mm, const Eigen::Vector3d& b_mm, std::vector<CellId>& out) const;

  /// Empty when the complex is sound, else what is wrong: Euler's formula per cell, two faces at every edge, vertices
  /// on the planes of their faces and within all others, the tree leading to the cell; over all cells, a cell on both
  /// sides of every wall and volumes that add up to the box, to 10^-9 or what rounding of coordinates leaves.
  /// O(all); for tests.
  [[nodiscard]] std::string validate() const;

 private:
  std::unique_ptr<CellStore> store_;
};

}  // namespace sonoloft
