#pragma once
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/cells/cell_store.h"

namespace sonoloft {

/// Whether both parts of a cell would reach at least width_mm from the plane.
[[nodiscard]] bool is_wide_enough(const Polyhedron& shape, const Plane& plane, double width_mm);

/// [#vertices] on which side (-1, 0, +1) of `plane` each vertex lies, exactly; empty when the cell is not to be cut
/// there: a part would not reach store.min_gap_mm from it.
[[nodiscard]] std::vector<std::int8_t> sides(const CellStore& store, const Polyhedron& shape, const Plane& plane);

/// Whether a face has vertices on both sides. @param side  see sides()
[[nodiscard]] bool is_crossed(const Polyhedron& shape, const PolyFace& face, std::span<const std::int8_t> side);

/// Cuts cells with one plane, one after the other; a wall between two cells that are both cut is split once.
class PlaneCut {
 public:
  PlaneCut(CellStore& store, PlaneId plane, CellComplex::Work& work)
      : store_(store), plane_(static_cast<std::uint32_t>(plane)), work_(work) {}

  /// The cell keeps its id for the part below. @param polygon what the slice has in the cell @param side see sides()
  /// @return the cell above
  CellId cut(CellId cell, FacePolygon polygon, std::span<const std::int8_t> side);
  /// The same where the slice is of the cell's own label all over.
  CellId cut_uniform(CellId cell, std::span<const std::int8_t> side);

 private:
  template <class MakePolygon>
  CellId cut_in_two(CellId cell, std::span<const std::int8_t> side, const MakePolygon& make_polygon);
  void split_walls(const Polyhedron& shape, std::span<const std::int8_t> side);
  void pass_walls_on(const Polyhedron& whole, Cell (&parts)[2]);

  CellStore& store_;
  std::uint32_t plane_;
  CellComplex::Work& work_;
  std::unordered_map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> halves_;  ///< [wall] below, above
};

}  // namespace sonoloft
