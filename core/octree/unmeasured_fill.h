#pragma once
#include <Eigen/Core>
#include <functional>
#include <span>

#include "core/background/background.h"
#include "core/cells/cell_complex.h"

namespace sonoloft {

/// Says which labels get what the walls of a cell did not measure of points in it: shares that sum to 1 at each point.
/// Empty: outside gets it all. Frame: reference, mm. Threads: many call it at a time.
using UnmeasuredFill = std::function<void(CellId cell, std::span<const Eigen::Vector3d> points_mm, PointShares& out)>;

}  // namespace sonoloft
