#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/field/field_evaluator.h"
#include "core/octree/bricks/brick_pool.h"
#include "core/octree/sampled_cells.h"
#include "core/octree/unmeasured_fill.h"
#include "core/slice/scratch_pool.h"
#include "core/slopes/contour_slopes.h"

namespace sonoloft {

/// Takes samples from the field, in rounds of many bricks; cells packed in one
/// round serve the later ones. Lives for one update: the cells do not change
/// meanwhile.
class Sampler {
 public:
  /// @param slopes  how contours move, or null: they do not
  /// @param fill    this and slopes live as long as the sampler
  Sampler(const CellComplex& cells, const ContourSlopes* slopes, FieldEvaluator& evaluator, const UnmeasuredFill& fill,
          const Eigen::Vector3d& origin_mm, double spacing_mm, int threads);

  /// Locates the samples of each job, evaluates them and writes cells, labels,
  /// shares and pins into the bricks.
  [[nodiscard]] Result<void> take(BrickPool& bricks, const std::vector<SampleJob>& jobs);

  /// How many of those of the last take() had not been taken before.
  [[nodiscard]] std::size_t first_taken() const { return first_taken_; }
  /// Calls visit(cell, brick) where the last take() found samples of a brick in a cell that had none of it.
  template <class Visit>
  void for_new_cells(const std::vector<SampleJob>& jobs, const Visit& visit) const {
    for (const Group& group : groups_)
      if (group.is_new) visit(static_cast<std::uint32_t>(sampled_.cell(group.packed)), jobs[group.job].brick);
  }

  [[nodiscard]] std::size_t evaluated() const { return evaluated_; }
  /// Edges that were summed for the samples taken.
  [[nodiscard]] std::size_t edge_evaluations() const { return edge_evaluations_; }
  [[nodiscard]] double field_ms() const { return field_ms_; }

 private:
  static constexpr std::uint32_t kNoBlock = 0xFFFFFFFF;
  /// The samples of one job that lie in one cell, and where their shares are
  /// found.
  struct Group {
    std::uint32_t job, packed;
    std::uint32_t first, count;  ///< in Located::index
    std::uint32_t block, lane;   ///< of the batch; block kNoBlock: the cell is constant
    bool is_new;                 ///< the brick had no other samples in the cell
  };
  /// The samples of one job, those of one cell together.
  struct Located {
    std::vector<std::uint16_t> index;  ///< of the sample in its brick
    std::vector<CellPoints> cells;
    std::uint32_t first_taken;
  };
  /// Room to work in for the samples of one brick, used again for brick after
  /// brick.
  struct Scratch {
    std::vector<std::uint16_t> index;
    std::vector<Eigen::Vector3d> points_mm;
    std::vector<std::uint32_t> order;
    PointShares filling;
    PointWeights rim;
    std::vector<float> filled;  ///< of the share of a group's points that was not measured, what `filling` gets
  };
  /// The samples of a group.
  [[nodiscard]] std::span<const std::uint16_t> samples_of(const Group& group) const {
    return {located_[group.job].index.data() + group.first, group.count};
  }
  /// What the samples of a brick have of a quantity that is a sum over the axes: [axis][coordinate].
  using Axes = std::array<std::array<double, kBrickSize>, 3>;
  [[nodiscard]] Axes axes_mm(BrickCoord brick) const;
  static void positions_mm(const Axes& axes_mm, std::span<const std::uint16_t> samples,
                           std::vector<Eigen::Vector3d>& out);
  void locate(const SampleJob& job, BrickCoord brick, Scratch& scratch, Located& out) const;
  [[nodiscard]] Result<void> evaluate(const BrickPool& bricks, const std::vector<SampleJob>& jobs);
  [[nodiscard]] const float* shares(const Group& group, std::size_t slot) const;
  void store(WorkBrick& brick, Group& group, Scratch& scratch) const;
  void fill_from_rims(WorkBrick& brick, const Group& group, Scratch& scratch) const;
  void fill_unmeasured(WorkBrick& brick, const Group& group, Scratch& scratch) const;
  void pin(WorkBrick& brick, const Group& group) const;

  const CellComplex& cells_;
  SampledCells sampled_;
  FieldEvaluator& evaluator_;
  const UnmeasuredFill& fill_;
  Eigen::Vector3d origin_mm_;
  double spacing_mm_;
  int threads_;
  FieldBatch batch_;
  ScratchPool<Scratch> scratches_;
  std::vector<Located> located_;  ///< [>= #jobs]
  std::vector<Group> groups_;     ///< by job
  std::size_t first_taken_ = 0, evaluated_ = 0, edge_evaluations_ = 0;
  double field_ms_ = 0;
};

}  // namespace sonoloft
