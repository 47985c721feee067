#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/kernels/layout.h"
#include "core/slice/label.h"

namespace sonoloft {

/// Cells in the form that the field kernels read: edges sorted by face and pair of labels, in single precision relative
/// to the centre of their cell and in units of its size. What a kernel calls a slot is a label of the cell.
/// Threads: one writer; const members may run together, but not during add() or clear().
class PackedCells {
 public:
  void clear();

  /// Appends a cell. A cell is constant when all of its walls are of one label, kUnknown among these.
  /// @param centre_mm  CellComplex::centre(), reference frame
  /// @param apart      ascending, indices of faces with unknown parts that get a slot each
  /// @return the cell's index here, 0, 1, ...
  /// @cost   O(#edges log #edges); allocates only when the buffers grow
  std::uint32_t add(std::span<const CellFace> faces, const Eigen::Vector3d& centre_mm,
                    std::span<const std::uint32_t> apart = {});

  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  /// The label of each slot, ascending: kUnknown comes last, once for all walls with unknown parts that are not apart,
  /// then once for each that is.
  [[nodiscard]] std::span<const Label> labels(std::uint32_t cell) const {
    return {labels_.data() + cells_[cell].first_label, cells_[cell].slot_count};
  }
  /// The whole cell is labels(cell)[0]: there is nothing to evaluate.
  [[nodiscard]] bool constant(std::uint32_t cell) const { return cells_[cell].slot_count == 1; }
  [[nodiscard]] const Eigen::Vector3d& centre_mm(std::uint32_t cell) const { return centres_mm_[cell]; }
  [[nodiscard]] std::uint32_t edge_count(std::uint32_t cell) const;  ///< evaluated for each point of the cell

  [[nodiscard]] std::span<const kernels::PackedCell> cells() const { return cells_; }
  [[nodiscard]] std::span<const kernels::PackedFace> faces() const { return faces_; }
  [[nodiscard]] std::span<const kernels::PackedRun> runs() const { return runs_; }
  [[nodiscard]] std::span<const kernels::PackedEdge> edges() const { return edges_; }

 private:
  struct SlottedEdge {
    kernels::PackedEdge edge;
    std::uint32_t left, right, order;
  };
  void collect_labels(std::span<const CellFace> faces, std::span<const std::uint32_t> apart);
  void add_face(const CellFace& face, const Eigen::Vector3d& centre_mm, double unit_mm, std::span<const Label> slots,
                std::uint32_t unknown_slot);

  std::vector<kernels::PackedCell> cells_;
  std::vector<kernels::PackedFace> faces_;
  std::vector<kernels::PackedRun> runs_;
  std::vector<kernels::PackedEdge> edges_;
  std::vector<Label> labels_;
  std::vector<Eigen::Vector3d> centres_mm_;
  std::vector<SlottedEdge> scratch_;
};

}  // namespace sonoloft
