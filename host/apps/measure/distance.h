#pragma once
#include "host/apps/measure/measure.h"

namespace sonoloft {

/// The two-sided distance between two sets of triangles; infinite if one of them is empty.
/// Threads: any number; the sums are taken in a fixed order.
[[nodiscard]] SurfaceDistance surface_distance(const IndexedMesh& mesh, const IndexedMesh& truth, int threads);

/// The triangles that bound a label, over the same positions.
[[nodiscard]] IndexedMesh triangles_of(const IndexedMesh& mesh, Label label);

}  // namespace sonoloft
