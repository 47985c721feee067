#pragma once
// update:  nodes whose shares changed -> [SURFACE CELLS] -> BackgroundChange
#include <vector>

#include "core/background/background.h"
#include "core/background/brick_table.h"
#include "core/background/cascade.h"

namespace sonoloft {

/// The cells of the lattice through which a surface runs: those whose eight corners have several largest labels. Nodes
/// beyond the lattice are outside, and cells at its rim have some.
class SurfaceCells {
 public:
  explicit SurfaceCells(const Eigen::Vector3i& nodes);

  /// By brick, ascending by z, y, x.
  std::vector<BackgroundChange> update(const BrickTable<NodeShares>& shares, const std::vector<RenewedNodes>& renewed);
  [[nodiscard]] std::vector<BackgroundChange> all() const;

 private:
  BrickTable<BackgroundMask> cells_;  ///< brick b of the nodes is b + 1 here: bricks of cells start one before
};

}  // namespace sonoloft
