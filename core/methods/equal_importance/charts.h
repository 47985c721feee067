#pragma once
// The charts that chart_of() tells apart. Each takes slices without unknown parts and at least two.
#include "core/methods/equal_importance/slice_chart.h"

namespace sonoloft {

/// Parallel slices: the height is the third coordinate; flat ends.
[[nodiscard]] Result<ChartedSlices> chart_stack(std::span<const TrackedSlice> slices, const std::string& method);

/// A line that lies in the planes of all slices and passes through what they show.
struct CommonAxis {
  Eigen::Vector3d point, direction;
};
[[nodiscard]] std::optional<CommonAxis> common_axis(std::span<const TrackedSlice> slices);

/// Slices through an axis: the angle is the third coordinate. Behind the last slice comes the first one, turned over.
[[nodiscard]] Result<ChartedSlices> chart_rotation(std::span<const TrackedSlice> slices, const CommonAxis& axis,
                                                   const std::string& method);

/// Slices along a curve through the middles of what they show. Between two planes lie those of their pencil, in frames
/// that turn from the one to the other as little as possible; flat ends.
/// @error invalid_argument: the contours of a slice reach through the plane of the next
[[nodiscard]] Result<ChartedSlices> chart_spine(std::span<const TrackedSlice> slices, const std::string& method);

/// [#values - 1]
[[nodiscard]] std::vector<double> differences(const std::vector<double>& ascending);

/// Completes labels and box from the sections.
void summarize(ChartedSlices& charted);

}  // namespace sonoloft
