#pragma once
// Stage 3 of 5:  cells -> field -> [OCTREE] -> mesh -> callback
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/background/background.h"
#include "core/cells/cell_complex.h"
#include "core/field/field_evaluator.h"
#include "core/octree/brick.h"
#include "core/octree/unmeasured_fill.h"
#include "core/slice/result.h"
#include "core/slopes/contour_slopes.h"

namespace sonoloft {

/// Samples of the field, only near its zero set and only renewed where cells or the background changed: a sparse
/// lattice of bricks of two levels of octants under an unbounded grid. Octants are sampled that a contour or a surface
/// of the background runs through, and from these on every octant behind a face with more than one label, until the
/// surfaces are closed. What is sampled, and its smoothed values, depend on the cells and on the walls noted, not on
/// when update() was called. Frame: reference, mm. Threads: one writer; const members may run together, but not during
/// update(). Source: Bermano, Vaxman, Gotsman 2011, sections 4.5 (octree) and 4.6 (smoothing).
class SampleOctree final : public SampleLattice {
 public:
  /// What one update() did.
  struct Change {
    std::vector<BrickCoord> bricks;    ///< with a cell of which a corner's smoothed sample or a contour changed,
                                       ///< appeared or vanished; ascending
    std::size_t evaluated = 0;         ///< samples taken from the field, those in constant cells among them
    std::size_t edge_evaluations = 0;  ///< edges of cells times these; far ones are summed together
    std::size_t smoothed_bricks = 0;
    double field_ms = 0, octree_ms = 0, smooth_ms = 0;
  };

  /// @param spacing_mm  edge of a finest cell
  SampleOctree(const Eigen::Vector3d& origin_mm, double spacing_mm);
  ~SampleOctree() override;
  SampleOctree(SampleOctree&&) noexcept;
  SampleOctree& operator=(SampleOctree&&) noexcept;

  /// Takes note of an insertion: call it right after every CellComplex::insert(), before the next.
  /// @cost O(edges of the new contours)
  void note(const CellComplex& cells, const CellComplex::Delta& delta);

  /// The same for every CellComplex::withdraw().
  void note(const CellComplex& cells, const CellComplex::Withdrawal& withdrawal);
  /// The same for every Background::update().
  void note(const Background& background, std::span<const BackgroundChange> changes);
  /// Cells in which what fills the unmeasured share, or how contours move, is no longer what it was.
  void note(std::span<const CellId> changed);

  /// Samples what was noted since the last update() made necessary.
  /// @error what the evaluator returned; the samples are then unusable
  /// @cost  O(samples in changed cells and in octants switched on or off)
  /// @param slopes  how contours move, or null: they do not
  [[nodiscard]] Result<Change> update(const CellComplex& cells, const ContourSlopes* slopes, FieldEvaluator& evaluator,
                                      const UnmeasuredFill& fill, int threads);

  [[nodiscard]] const Brick* find(BrickCoord coord) const override;
  [[nodiscard]] std::span<const ContourPiece> contours(BrickCoord coord) const override;
  [[nodiscard]] Eigen::Vector3d origin_mm() const override;
  [[nodiscard]] double spacing_mm() const override;
  [[nodiscard]] std::size_t sample_count() const;
  /// Of these, those in cells that are noted as changed: the next update() takes them again. O(1)
  [[nodiscard]] std::size_t stale_count() const;
  [[nodiscard]] std::size_t brick_count() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft
