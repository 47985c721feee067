#pragma once
#include "core/mesh/mesh.h"
#include "device_sim/probe/phantom.h"

namespace sonoloft::test {

/// The surface of a body as a closed mesh, drawn on a lattice of 160 steps along its longest side from the shares of
/// labels around each point; edges and junctions are rounded by a step, the rest lies within a tenth of one.
/// @cost  a second or two
[[nodiscard]] IndexedMesh true_surface(const device_sim::Phantom& body);

}  // namespace sonoloft::test
