#pragma once
// distance:  NodeData -> [SEEN NODES] -> distance of points to them
#include <span>
#include <vector>

#include "core/background/brick_table.h"
#include "core/background/node_block.h"

namespace sonoloft {

/// A node this heavy has a slice within about 0.6 spacings.
inline constexpr std::uint32_t kSeenWeight = kWeightUnit * 2 / 5;

/// Distance of points to the nearest node with kSeenWeight, in spacings, at most `reach`.
/// @param out  [#P]
void distance_to_seen(const NodeLattice& lattice, const BrickTable<NodeData>& data,
                      std::span<const Eigen::Vector3d> points_mm, int reach, std::span<float> out);

}  // namespace sonoloft
