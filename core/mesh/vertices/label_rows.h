#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/mesh/vertices/cell_samples.h"

namespace sonoloft {

/// The labels of a block as bits: bit x of a row is set where sample x of a row along x has the label. So a row of
/// cells is looked through in a few operations a label.
class LabelRows {
 public:
  void read(const BlockLabels& labels);

  /// Calls visit(at) for every cell of the brick that has all corners sampled and not all of one label, with its labels
  /// and their corners in `cell`.
  template <class Visit>
  void for_mixed_cells(CellSamples& cell, const Visit& visit) const {
    for (int z = 0; z < kBrickSize; ++z)
      for (int y = 0; y < kBrickSize; ++y)
        for (unsigned rest = mixed_[row_of(y, z)]; rest != 0; rest &= rest - 1) {
          const int x = std::countr_zero(rest);
          find_labels(row_of(y, z), x, cell);
          visit(LocalPoint{x, y, z});
        }
  }

  /// The samples of a row, y + BlockGrid::kSide * z, that are a corner of such a cell.
  [[nodiscard]] unsigned corners_of_mixed(int row) const { return corners_[static_cast<std::size_t>(row)]; }

 private:
  using Rows = std::array<std::uint16_t, BlockGrid::kRows>;
  struct OneLabel {
    Label label;
    Rows rows;
  };
  static constexpr std::size_t row_of(int y, int z) { return static_cast<std::size_t>(y + BlockGrid::kSide * z); }
  /// The four rows of samples that a row of cells lies between, in the order of the cell's corners.
  static constexpr std::array<std::size_t, 4> kBetween = {0, 1, BlockGrid::kSide, BlockGrid::kSide + 1};

  void add(Label label, const BlockLabels& labels);
  [[nodiscard]] unsigned mixed_in(std::size_t row) const;
  void find_labels(std::size_t row, int x, CellSamples& cell) const;

  std::vector<OneLabel> labels_;  ///< ascending; kNotSampled is one of them
  Rows mixed_;                    ///< the cells that for_mixed_cells() visits, under their lowest corner's row
  Rows corners_;                  ///< see corners_of_mixed()
};

}  // namespace sonoloft
