#pragma once
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/background/background.h"
#include "core/cells/cell_complex.h"
#include "core/field/field_evaluator.h"
#include "core/slice/result.h"
#include "core/slice/scratch_pool.h"
#include "core/slice/section.h"

namespace sonoloft {

/// Which cells a slice is to cut: those in which it says what the slices before it do not say already. What cuts
/// nothing is not lost: it counts in the background. All lengths follow from the background's spacing H, 2.5 mm in a
/// body. Source: docs/pipeline/9-background.md.
class CellAdmission {
 public:
  /// How far both parts must reach from the slice, mm; a cell that is not in here is not to be cut.
  using Widths = std::unordered_map<CellId, double>;

  /// Compares the slice's labels, on a raster of 0.6 H, with what the field has there.
  /// @param background  without the slice
  /// @error opencl_failed
  /// @cost  O(edges of the cells reached for the first time since they changed + raster points times edges of their
  /// cell)
  [[nodiscard]] Result<Widths> judge(const Section& section, const CellComplex& cells, const Background& background,
                                     FieldEvaluator& evaluator, int threads);

  /// Call it for cells that were divided, or are no more: they are kept as the field needs them from slice to slice.
  void forget(std::span<const CellId> changed);

 private:
  static constexpr std::uint32_t kNotPacked = 0xFFFFFFFF;
  /// Points of one cell: point_mm_[first, first + count).
  struct Group {
    CellId cell;
    std::uint32_t first, count;
    std::uint32_t packed, block;  ///< block: meaningless when the cell is constant
  };
  struct Scratch {
    PointShares near;
    std::vector<float> weight;
  };
  void raster(const Section& section, const CellComplex& cells, double spacing_mm);
  void pack(const CellComplex& cells);
  [[nodiscard]] double width(const Group& group, const Background& background, Scratch& scratch) const;

  std::vector<Eigen::Vector3d> point_mm_;  ///< of the raster, those of one cell together
  std::vector<Label> label_;               ///< [point_mm_] what the slice says
  std::vector<Group> groups_;
  FieldBatch batch_;                           ///< its cells stay from slice to slice
  std::vector<std::uint32_t> packed_of_cell_;  ///< [CellId] index in batch_.cells, or kNotPacked
  std::size_t forgotten_ = 0;                  ///< cells in batch_ that are no more
  ScratchPool<Scratch> scratches_;
};

}  // namespace sonoloft
