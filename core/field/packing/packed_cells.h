#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/field/packing/bent_face.h"
#include "core/kernels/layout.h"
#include "core/slice/label.h"

namespace sonoloft {

/// Cells in the form that the field kernels read: edges sorted by face and pair of labels, in single precision relative
/// to the centre of their cell and in units of its size. What a kernel calls a slot is a label of the cell. Of the
/// parts of a face the kernel takes the whole face and all parts but one: what is left belongs to that one. Threads:
/// one writer; const members may run together, but not during add() or clear().
class PackedCells {
 public:
  void clear();

  /// Appends a cell. A cell is constant when all of its walls are of one label, kUnknown among these.
  /// @param centre_mm  CellComplex::centre(), reference frame
  /// @param apart      ascending, indices of faces with unknown parts that get a slot each
  /// @param bends      [faces] how contours move with the height over their face; empty: none moves
  /// @return the cell's index here, 0, 1, ...
  /// @cost   O(#edges log #edges); allocates only when the buffers grow
  std::uint32_t add(std::span<const CellFace> faces, const Eigen::Vector3d& centre_mm,
                    std::span<const std::uint32_t> apart = {}, std::span<const FaceBends> bends = {});

  /// Appends the cells of another one, as if each had been added here. @cost O(what they hold), allocates
  void append(const PackedCells& others);

  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  /// The label of each slot, ascending: kUnknown comes last, once for all walls with unknown parts that are not apart,
  /// then once for each that is.
  [[nodiscard]] std::span<const Label> labels(std::uint32_t cell) const {
    return {labels_.data() + cells_[cell].first_label, cells_[cell].slot_count};
  }
  /// The whole cell is labels(cell)[0]: there is nothing to evaluate.
  [[nodiscard]] bool constant(std::uint32_t cell) const { return cells_[cell].slot_count == 1; }
  [[nodiscard]] const Eigen::Vector3d& centre_mm(std::uint32_t cell) const { return centres_mm_[cell]; }
  [[nodiscard]] std::uint32_t edge_count(
      std::uint32_t cell) const;  ///< what a point sums that is far from none of them

  [[nodiscard]] std::span<const kernels::PackedCell> cells() const { return cells_; }
  [[nodiscard]] std::span<const kernels::PackedFace> faces() const { return faces_; }
  [[nodiscard]] std::span<const kernels::PackedRun> runs() const { return runs_; }
  [[nodiscard]] std::span<const kernels::PackedEdge> edges() const { return edges_; }
  [[nodiscard]] std::span<const kernels::PackedVertex> vertices() const { return vertices_; }
  [[nodiscard]] std::span<const kernels::PackedStretch> stretches() const { return stretches_; }

 private:
  /// A border or a piece of an outline, between the slots left < right.
  struct SlottedEdge {
    std::uint32_t edge;  ///< of the polygon
    bool bent, turned;   ///< turned: its labels were the other way round, so it goes from b to a
    std::uint32_t left, right;
  };
  /// Edges that come one after the other in the polygon and have the same slots. Bent ones also form a chain.
  struct Piece {
    bool bent, turned;
    std::uint32_t left, right;
    std::uint32_t first_edge, behind_last;  ///< of the polygon
    Eigen::Vector2d start, end;             ///< turned if they are
    bool follows = false, taken = false;
  };
  /// Image of a face's plane, in units of the cell's size.
  struct Image {
    Eigen::Vector2d centre;
    double unit_mm;
    float side;  ///< +1: the cell lies on the side of the normal
    [[nodiscard]] Eigen::Vector2f operator()(const Eigen::Vector2d& p) const {
      return ((p - centre) / unit_mm).cast<float>();
    }
  };
  void collect_labels(std::span<const CellFace> faces, std::span<const std::uint32_t> apart);
  void add_face(const CellFace& face, const Eigen::Vector3d& centre_mm, double unit_mm, std::span<const Label> slots,
                std::uint32_t unknown_slot, const FaceBends& bends);
  void add_edge(const Image& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
  void add_vertex(const Image& image, const Eigen::Vector2d& point, const VertexBend& bend);
  void collect_edges(const FacePolygon& polygon, std::span<const Label> slots, std::uint32_t unknown_slot,
                     std::span<const EdgeBends> bends);
  void cut_into_pieces(const FacePolygon& polygon, std::span<const Label> slots, std::uint32_t unknown_slot,
                       std::span<const EdgeBends> bends);
  void link(std::span<Piece> pieces);
  void take(const Piece& piece);
  [[nodiscard]] std::size_t add_rigid_run(const FacePolygon& polygon, const Image& image, std::size_t first);
  [[nodiscard]] std::size_t add_bent_run(const FacePolygon& polygon, const Image& image,
                                         std::span<const EdgeBends> bends, std::size_t first);

  std::vector<kernels::PackedCell> cells_;
  std::vector<kernels::PackedFace> faces_;
  std::vector<kernels::PackedRun> runs_;
  std::vector<kernels::PackedEdge> edges_;
  std::vector<kernels::PackedVertex> vertices_;
  std::vector<kernels::PackedStretch> stretches_;
  std::vector<Label> labels_;
  std::vector<Eigen::Vector3d> centres_mm_;
  std::vector<SlottedEdge> slotted_;
  std::vector<Piece> pieces_;
  BentFace bent_face_;
};

}  // namespace sonoloft
