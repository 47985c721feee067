#pragma once
#include <Eigen/Core>
#include <functional>
#include <span>

#include "core/background/background.h"
#include "core/background/rim.h"
#include "core/cells/cell_complex.h"

namespace sonoloft {

/// Says which labels get what the walls of a cell did not measure of points in it. Frame: reference, mm. Threads: many
/// call it at a time.
struct UnmeasuredFill {
  /// Shares that sum to 1 at each point. Empty: outside gets it all.
  std::function<void(CellId cell, std::span<const Eigen::Vector3d> points_mm, PointShares& out)> shares;
  /// What has a say besides in the unknown parts of a slice's walls. May be empty.
  std::function<const Rim&(SliceId slice)> rim;
};

}  // namespace sonoloft
