#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/vertices/cell_samples.h"
#include "core/mesh/vertices/label_rows.h"

namespace sonoloft {

/// Two labels, ascending.
struct LabelPair {
  Label lower, upper;
  friend bool operator==(const LabelPair&, const LabelPair&) = default;
};

/// The samples of a block, see BlockGrid: flat arrays, gathered once.
class SampleBlock {
 public:
  /// Reads the labels of a brick; the shares are read when they are asked for. False if there is no brick.
  bool select(const SampleLattice& lattice, const BrickCoord& coord);

  /// Which labels are where; kNotSampled where there is no brick.
  [[nodiscard]] const LabelRows& rows() const { return rows_; }

  /// The way to the border between two labels from every corner of a mixed cell: positive where the first is the
  /// stronger.
  const float* gap_plane(const LabelPair& pair) {
    for (std::size_t i = 0; i < used_planes_; ++i)
      if (planes_[i].pair == pair) return planes_[i].gap.data();
    return add_gap_plane(pair);
  }

  /// Fills in the shares and the distances from slices of a cell whose labels are known.
  void find_shares(LocalPoint cell, CellSamples& samples);

 private:
  /// Where the shares of a label are in each of the bricks.
  struct Shares {
    Label label;
    std::array<const float*, 8> of_brick;  ///< [kBrickSamples] each
  };
  struct Plane {
    LabelPair pair;
    std::array<float, BlockGrid::kPoints> gap;
  };
  const float* add_gap_plane(const LabelPair& pair);
  /// Valid until it is asked for another label.
  const std::array<const float*, 8>& shares_of(Label label);
  [[nodiscard]] const float* slice_steps_of(std::size_t which) const;

  std::array<const Brick*, 8> bricks_{};  ///< on the upper side in x, y, z where bit 0, 1, 2 of the index is set
  LabelRows rows_;
  std::vector<Shares> shares_;   ///< that were asked for
  std::size_t used_planes_ = 0;  ///< for this brick
  std::vector<Plane> planes_;
};

}  // namespace sonoloft
