#pragma once
// Beside the stages:  cells -> [COMPLETION] -> field (what lies behind unknown walls), instead of the background
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>

#include "core/background/background.h"
#include "core/cells/cell_complex.h"

namespace sonoloft {

/// The published way to complete unknown parts of slices, for comparison and for small sets: every unknown part is
/// triangulated; corners get a share of every label from the known walls of the cells around; in between shares are
/// linear, and a cell weighs the patches on its walls like known parts. It sees one state of the cells and is made anew
/// when they change. Known corners of the triangles have their label, so that what is found continues what is known;
/// the triangles belong to the plane, so that it is the same from both sides of every wall. Independent of units.
/// Frame: reference, mm. Threads: all members may run together.
/// Source: Bermano, Vaxman, Gotsman 2011, section 5, equation 7; docs/pipeline/11-completion.md.
class PublishedCompletion {
 public:
  /// @param cells       as they are now: not looked at later
  /// @param hops        a corner sees the cells on both sides of it and those over hops - 1 unknown walls from these;
  ///                    none: over any number of unknown walls
  /// @param spacing_mm  of the corners where materials are; wider outside of their bounds; > 0
  /// @pre   hops >= 1, threads >= 1
  /// @cost  O(corners * known borders in the cells that each sees): seconds to minutes
  PublishedCompletion(const CellComplex& cells, std::optional<int> hops, double spacing_mm, int threads);
  ~PublishedCompletion();
  PublishedCompletion(PublishedCompletion&&) noexcept;
  PublishedCompletion& operator=(PublishedCompletion&&) noexcept;

  /// Of the share that a cell's walls did not measure of points, what each label gets. A cell without unknown walls:
  /// outside.
  /// @pre  the points lie in the cell or within rounding of it
  /// @cost O(#P * borders of patches on the cell's walls)
  void shares(CellId cell, std::span<const Eigen::Vector3d> points_mm, PointShares& out) const;

  /// Cells with unknown walls, ascending: others are not completed.
  [[nodiscard]] std::span<const CellId> cells() const;
  [[nodiscard]] std::size_t corner_count() const;  ///< of triangles, that were not known

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft
