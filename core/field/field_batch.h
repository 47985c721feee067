#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "core/field/packing/packed_cells.h"
#include "core/kernels/layout.h"

namespace sonoloft {

/// Points of one cell: what add_block() appended.
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
  std::size_t weight_count = 0;            ///< length of `weight` that the blocks need
  std::vector<float> weight;               ///< room for the evaluator to work in
  std::vector<float> share;                ///< per block: [slots of its cell][stride]; written by evaluate()

  void clear();         ///< cells and points
  void clear_points();  ///< points only; the cells may be used again

  /// Appends room for points of a cell. @pre !cells.constant(cell), count >= 1 @return the index of the block
  std::uint32_t add_block(std::uint32_t cell, std::uint32_t count);
  /// Fills points of a block from its point `first` on; all of them before evaluate(). They lie in the cell or within
  /// rounding of it, all finite. Threads: any number at a time, for different points.
  /// @param point  of a number below count, an Eigen::Vector3f from the centre of the cell
  template <class Point>
  void set_points(std::uint32_t block, std::uint32_t first, std::uint32_t count, const Point& point) {
    const FieldBlock& b = blocks[block];
    assert(first + count <= b.count);
    const std::uint32_t filled = first + count == b.count ? b.stride - first : count;  // last lanes: the last point
    for (std::uint32_t i = 0; i < filled; ++i) {
      const Eigen::Vector3f p = point(std::min(i, count - 1));
      const std::size_t at = std::size_t{b.first_point} + first + i;
      x[at] = p.x();
      y[at] = p.y();
      z[at] = p.z();
    }
  }
  /// A block of these points. @return its index
  std::uint32_t add_points(std::uint32_t cell, std::span<const Eigen::Vector3d> points_mm) {
    const auto count = static_cast<std::uint32_t>(points_mm.size());
    const std::uint32_t block = add_block(cell, count);
    const Eigen::Vector3d& centre_mm = cells.centre_mm(cell);
    set_points(block, 0, count,
               [&](std::size_t i) -> Eigen::Vector3f { return (points_mm[i] - centre_mm).cast<float>(); });
    return block;
  }

  /// After evaluate(): what the points of a block have of label cells.labels(cell)[slot]; [#points of the block].
  /// In [0, 1] up to rounding, all of them together 1. The row of kUnknown says how much was not measured.
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
