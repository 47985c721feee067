#pragma once
// slices -> [SLICE CHART] -> where a point lies between two slices, as if all were a stack
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/slice/result.h"
#include "core/slice/section.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// Where a point lies among charted sections.
struct ChartPlace {
  std::size_t interval;  ///< between sections[interval] and the next one
  double share;          ///< of the way to that, 0..1
  Eigen::Vector2d at;    ///< mm, in the frames of both sections
  double step_mm;        ///< how far these are apart here
  double to_end_mm;      ///< from the nearer end of the slices, negative beyond; infinite where there is none
};

/// A way to see space as a stack of sections. Frame of points: that of ChartedSlices. Threads: any number.
class SliceChart {
 public:
  virtual ~SliceChart() = default;
  /// Nothing where no section has a point opposite. @cost O(1) to O(#sections)
  [[nodiscard]] virtual std::optional<ChartPlace> locate(const Eigen::Vector3d& point_mm) const = 0;
};

struct ChartedSlices {
  Eigen::Isometry3d frame_to_reference = Eigen::Isometry3d::Identity();
  std::vector<Section> sections;  ///< [#S >= 2] neighbours in order; image_to_reference leads to the frame
  std::vector<double> steps;      ///< [#S - 1] how far apart they are, in mm or as angles
  std::vector<Label> labels;      ///< ascending; outside is the first
  Eigen::AlignedBox3d box;        ///< of all contours, in the frame
  std::unique_ptr<SliceChart> chart;
};

/// Finds out how slices lie to each other, to 1 degree and 0.5 % of their extent:
/// parallel, a stack in any order; all through one axis that runs through what they show, rotated about it, in any
/// order; or one behind the other along a curve, in the order of the curve, with planes that do not cross inside of
/// what the neighbours show.
/// @error invalid_argument (none of these; fewer than two; unknown parts), empty_input; those of make_section()
[[nodiscard]] Result<ChartedSlices> chart_of(std::span<const TrackedSlice> slices, const std::string& method);

}  // namespace sonoloft
