#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/background/background.h"
#include "core/cells/cell_complex.h"
#include "core/field/field_evaluator.h"
#include "core/octree/brick_pool.h"

namespace sonoloft {

/// Samples of one brick to be taken.
struct SampleJob {
  std::uint32_t brick;
  SampleMask samples;
};

/// Takes samples from the field, in rounds of many bricks; cells packed in one round serve the later ones. Lives for
/// one update: the cells do not change meanwhile.
class Sampler {
 public:
  /// @param background  what fills the share of a sample that was not measured; null: outside does
  Sampler(const CellComplex& cells, FieldEvaluator& evaluator, const Background* background,
          const Eigen::Vector3d& origin_mm, double spacing_mm, int threads);

  /// Locates the samples of each job, evaluates them and writes cell, label, shares and pins into the bricks.
  /// @return [#jobs] the cells that each brick's samples were found in, without repeats
  [[nodiscard]] Result<std::vector<std::vector<std::uint32_t>>> take(BrickPool& bricks,
                                                                     const std::vector<SampleJob>& jobs);

  [[nodiscard]] std::size_t evaluated() const { return evaluated_; }
  /// Edges that were summed for the samples taken.
  [[nodiscard]] std::size_t edge_evaluations() const { return edge_evaluations_; }
  [[nodiscard]] double field_ms() const { return field_ms_; }

 private:
  /// The samples of one job that lie in one cell, and where their shares are found.
  struct Group {
    std::uint32_t job, packed;
    std::uint32_t first, count;  ///< in Located::index
    std::uint32_t block, lane;   ///< of the batch; block kNoBlock: the cell is constant
  };
  /// The samples of one job, those of one cell together.
  struct Located {
    std::vector<std::uint16_t> index;  ///< of the sample in its brick
    std::vector<Eigen::Vector3d> point_mm;
    std::vector<CellPoints> cells;
  };
  /// A slice beside which samples are pinned: normal . x + offset = signed distance, mm.
  struct PinPlane {
    Eigen::Vector3d normal;
    double offset_mm;
  };
  struct PinRange {
    std::uint32_t first, count;
  };
  void locate(const WorkBrick& brick, const SampleMask& samples, Located& out) const;
  void pack(std::uint32_t cell);
  [[nodiscard]] Result<void> evaluate();
  void store(WorkBrick& brick, const Group& group, const Located& located, PointShares& scratch) const;
  void fill_unmeasured(WorkBrick& brick, std::span<const std::uint16_t> index,
                       std::span<const Eigen::Vector3d> points_mm, PointShares& scratch) const;
  void pin(WorkBrick& brick, const Group& group, std::span<const std::uint16_t> index,
           std::span<const Eigen::Vector3d> points_mm) const;

  const CellComplex& cells_;
  FieldEvaluator& evaluator_;
  const Background* background_;
  Eigen::Vector3d origin_mm_;
  double spacing_mm_;
  int threads_;
  FieldBatch batch_;
  std::vector<std::uint32_t> packed_of_cell_;  ///< [cell] index in batch_.cells, kNoCell
  std::vector<std::uint32_t> cell_of_packed_;
  std::vector<PinRange> pins_of_packed_;
  std::vector<PinPlane> pins_;
  std::vector<CellFace> faces_;
  std::vector<Located> located_;  ///< [#jobs]
  std::vector<Group> groups_;     ///< by job
  std::size_t evaluated_ = 0, edge_evaluations_ = 0;
  double field_ms_ = 0;
};

}  // namespace sonoloft
