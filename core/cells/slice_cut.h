#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/cells/plane_cut.h"
#include "core/cells/slice_walk.h"

namespace sonoloft {

/// Cuts cells with one slice. A cell of one label in which the slice says nothing else is not cut: it remembers the
/// plane. When a later slice does say something else there, the cell is first cut by the planes that it remembers, in
/// their order, as far as that slice is concerned. So cells multiply around surfaces only, and these are the cells that
/// cutting at once would give.
class SliceCut {
 public:
  /// @param plane  the slice's, already in the store
  SliceCut(CellStore& store, std::uint32_t plane, CellComplex::Delta& delta)
      : store_(store), plane_(plane), delta_(delta) {}

  /// @param width_mm  how far both parts must reach from the plane
  void cut(Arrival arrival, double width_mm);
  /// Whether a cell was cut or remembers the plane.
  [[nodiscard]] bool used_plane() const { return used_; }

 private:
  void cut_by_slice(Arrival arrival);
  /// Cuts the cell by the first plane that it remembers. @param left  takes what the slice has in the parts
  void cut_by_remembered(Arrival arrival, std::vector<Arrival>& left);

  CellStore& store_;
  std::uint32_t plane_;
  CellComplex::Delta& delta_;
  std::map<std::uint32_t, PlaneCut> cuts_;  ///< [plane] a wall between two cells is split once for both
  bool used_ = false;
};

}  // namespace sonoloft
