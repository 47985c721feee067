#pragma once
#include "core/octree/brick_pool.h"

namespace sonoloft {

/// Bi-Laplacian smoothing of the samples of one brick: f - 1/4 L(L f) for the share of every label, L the mean of the
/// six neighbours minus the sample itself. Samples within a finest cell of a slice stay as they are, which keeps the
/// contours; so do those with a finest cell beside them that was not sampled whole, which keeps the surface inside of
/// what was sampled.
/// Reads samples up to two steps outside of the brick. Source: Bermano, Vaxman, Gotsman 2011, section 4.6.
/// Shares add up to 1, so the first label's change is what the others' changes leave.
/// @return the samples in which brick.smooth changed
SampleMask smooth_brick(const BrickPool& bricks, WorkBrick& brick);

}  // namespace sonoloft
