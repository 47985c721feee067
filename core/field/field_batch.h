#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/field/packed_cells.h"
#include "core/kernels/layout.h"

namespace sonoloft {

/// Points of one cell: what add_points() appended.
struct FieldBlock {
  std::uint32_t cell;         ///< index in FieldBatch::cells
  std::uint32_t count;        ///< points, >= 1
  std::uint32_t first_point;  ///< in x, y, z
  std::uint32_t first_share;  ///< in share
  std::uint32_t stride;       ///< count rounded up to whole lanes: distance of two rows in share
};

/// A pile of points to evaluate: fill `cells` and points, pass it to FieldEvaluator::evaluate(), read the rows of
/// shares. Keep it and clear() it: the buffers stay. Threads: one writer.
struct FieldBatch {
  PackedCells cells;
  std::vector<FieldBlock> blocks;          ///< [#B]
  std::vector<kernels::PackedTask> tasks;  ///< the blocks cut into whole lanes
  std::vector<float> x, y, z;              ///< [#P] mm, relative to the centre of the block's cell
  std::size_t share_count = 0;             ///< length of `share` that the blocks need
  std::vector<float> share;                ///< per block: [slots of its cell][stride]; written by evaluate()

  void clear();         ///< cells and points
  void clear_points();  ///< points only; the cells may be used again

  /// Appends points that lie in the cell (or within rounding of it).
  /// @pre    !cells.constant(cell), points not empty, all finite
  /// @return the index of the block
  std::uint32_t add_points(std::uint32_t cell, std::span<const Eigen::Vector3d> points_mm);

  /// After evaluate(): what the points of a block have of label cells.labels(cell)[slot]; [#points of the block].
  /// In [0, 1] up to rounding. The rows of the known labels sum to 1; the row of kUnknown says how much of that was not
  /// measured but filled in.
  [[nodiscard]] std::span<const float> row(std::uint32_t block, std::uint32_t slot) const {
    const FieldBlock& b = blocks[block];
    return {share.data() + b.first_share + std::size_t{slot} * b.stride, b.count};
  }
  [[nodiscard]] std::span<float> row(std::uint32_t block, std::uint32_t slot) {
    const FieldBlock& b = blocks[block];
    return {share.data() + b.first_share + std::size_t{slot} * b.stride, b.count};
  }
};

}  // namespace sonoloft
