#pragma once
#include <span>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft::test {

/// How far each point is from the nearest triangle. @return [#points] mm
[[nodiscard]] std::vector<double> distances(std::span<const Eigen::Vector3d> points_mm, const IndexedMesh& mesh);

/// How far each contour point of the slices is from the nearest triangle. @return [#points] mm
[[nodiscard]] std::vector<double> contour_distances(std::span<const TrackedSlice> slices, const IndexedMesh& mesh);

}  // namespace sonoloft::test
