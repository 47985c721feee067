#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/slopes/vertex_bend.h"

namespace sonoloft {

/// Tangents, curvatures and slopes at the contours of all slices held, from the slices around them, kept up to date
/// slice by slice. What they are after an update() depends on the slices held and the cells, not on the updates before.
/// Frame: reference, mm. Threads: one writer; bends() may be read by many, but not during update().
/// Source: docs/pipeline/12-slopes.md.
class ContourSlopes {
 public:
  /// @param feature_mm  about a 60th of the object: windows along contours are some of these
  explicit ContourSlopes(double feature_mm);
  ~ContourSlopes();
  ContourSlopes(ContourSlopes&&) noexcept;
  ContourSlopes& operator=(ContourSlopes&&) noexcept;

  /// Takes note of an insertion or a withdrawal: call it after every one, before the next. O(cells changed)
  void note(const CellComplex::Delta& delta);
  void note(SliceId withdrawn, const CellComplex::Withdrawal& withdrawal);

  /// Brings everything up to date with what was noted.
  /// @return cells with a contour on a wall whose bends changed, ascending, besides those noted as changed since the
  /// last
  ///         update(), which may be among them
  [[nodiscard]] std::vector<CellId> update(const CellComplex& cells, int threads);

  /// [Section::points] of a slice that was noted before the last update(). Valid until the next.
  [[nodiscard]] std::span<const VertexBend> bends(SliceId slice) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft
