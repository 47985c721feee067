#pragma once
// add, remove:  Section -> raster -> [SPLAT] -> NodeData
#include <Eigen/Geometry>

#include "core/background/brick_table.h"
#include "core/background/node_block.h"
#include "core/slice/section_raster.h"

namespace sonoloft {

/// Adds the pixels of a slice to the eight nodes around each, every one with its share of the pixel's area, rounded to
/// whole units: sums do not depend on order, and what was added can be taken away again. Nodes beyond the table get
/// nothing. Weights stay below 2 units a slice and node.
/// @param sign     1 adds, -1 takes away
/// @param changed  out, the nodes touched
void splat(const NodeLattice& lattice, const Eigen::Isometry3d& image_to_reference, const SectionRaster& raster,
           int sign, BrickTable<NodeData>& data, ChangedNodes& changed);

}  // namespace sonoloft
