#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"

namespace sonoloft {

/// The label of any point of space, from samples near the surfaces: of those whose trilinearly interpolated share is
/// largest, the lowest. Lengths in lattice steps.
/// Mixed finest cells stand in rows along x. A cell that is not in its row has one label throughout, and so have all
/// cells between two entries of a row: that of the wall they share with the entry before.
class LabelOracle {
 public:
  /// @param live  drawn from `samples`: tells where mixed cells are
  LabelOracle(const SampleLattice& samples, const MeshSnapshot& live);

  /// O(log of the cells in a row)
  [[nodiscard]] Label label(const Eigen::Vector3d& point) const;

  [[nodiscard]] const Eigen::Vector3i& lowest() const { return lowest_; }    ///< of the box of all mixed cells
  [[nodiscard]] const Eigen::Vector3i& highest() const { return highest_; }  ///< the same, upper corner

 private:
  struct MixedCell {
    Eigen::Vector3i at;         ///< lowest corner
    Label beyond;               ///< of the wall on the upper x side, where the next cell is not mixed
    std::uint16_t label_count;  ///< labels with a share in a corner
    std::uint32_t first;        ///< in labels_ and shares_
  };
  void add_cells(const SampleLattice& samples, const BrickCoord& coord);
  void sort_into_rows();
  [[nodiscard]] Label label_in(const MixedCell& cell, const Eigen::Vector3d& offset) const;
  [[nodiscard]] std::size_t row(int y, int z) const {
    return static_cast<std::size_t>(z - lowest_.z()) * static_cast<std::size_t>(highest_.y() - lowest_.y()) +
           static_cast<std::size_t>(y - lowest_.y());
  }

  std::vector<MixedCell> cells_;              ///< by row, then x
  std::vector<std::uint32_t> row_begin_;      ///< [#rows + 1] in cells_
  std::vector<Label> labels_;                 ///< ascending within a cell
  std::vector<std::array<float, 8>> shares_;  ///< [labels_] in the corners, x fastest
  Eigen::Vector3i lowest_ = Eigen::Vector3i::Zero(), highest_ = Eigen::Vector3i::Zero();
};

}  // namespace sonoloft
