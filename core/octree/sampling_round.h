#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

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
  Sampler(const CellComplex& cells, FieldEvaluator& evaluator, const Eigen::Vector3d& origin_mm, double spacing_mm,
          int threads);

  /// Locates the samples of each job, evaluates them and writes cell, label, shares and pins into the bricks.
  /// @return [#jobs] the cells that each brick's samples were found in, without repeats
  [[nodiscard]] Result<std::vector<std::vector<std::uint32_t>>> take(BrickPool& bricks,
                                                                     const std::vector<SampleJob>& jobs);

  [[nodiscard]] std::size_t evaluated() const { return evaluated_; }
  [[nodiscard]] double field_ms() const { return field_ms_; }

 private:
  /// A slice beside which samples are pinned: normal . x + offset = signed distance, mm.
  struct PinPlane {
    Eigen::Vector3d normal;
    double offset_mm;
  };
  struct CellWalls {
    std::uint32_t first_pin, pin_count;
  };
  void locate(const BrickPool& bricks, const std::vector<SampleJob>& jobs);
  void pack(const std::vector<std::vector<std::uint32_t>>& found);
  [[nodiscard]] Result<void> evaluate();
  void store(WorkBrick& brick, const SampleMask& samples, std::size_t first);
  [[nodiscard]] bool pinned(std::uint32_t packed, const Eigen::Vector3d& point) const;

  const CellComplex& cells_;
  FieldEvaluator& evaluator_;
  Eigen::Vector3d origin_mm_;
  double spacing_mm_;
  int threads_;
  FieldBatch batch_;
  std::vector<std::uint32_t> packed_of_cell_;  ///< [cell] index in batch_.cells, kNoCell
  std::vector<CellWalls> walls_;               ///< [packed cell]
  std::vector<PinPlane> pins_;
  std::vector<CellFace> faces_;
  std::vector<std::size_t> first_of_job_;    ///< [#jobs + 1] where its points start
  std::vector<Eigen::Vector3d> points_;      ///< [#points of the round]
  std::vector<CellId> cell_;                 ///< [#points]
  std::vector<std::uint32_t> block_, lane_;  ///< [#points] where the shares are found; block kNoCell: constant cell
  std::size_t evaluated_ = 0;
  double field_ms_ = 0;
};

}  // namespace sonoloft
