#pragma once
// slices -> [SLICE STACK] -> parallel sections in one frame -> a method's field
#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "core/slice/result.h"
#include "core/slice/section.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// Parallel slices in a frame of their own: z along their normals, the origin in the middle of all contours.
struct SliceStack {
  Eigen::Isometry3d stack_to_reference = Eigen::Isometry3d::Identity();
  std::vector<Section> sections;    ///< [#S >= 2] ascending by height; image_to_reference lifts them to it
  std::vector<double> heights_mm;   ///< [#S]
  std::vector<std::size_t> slices;  ///< [#S] which slice each was made of, from 1: what messages call it
  std::vector<Label> labels;        ///< ascending; outside is the first
  Eigen::AlignedBox2d bounds;       ///< of all contours

  [[nodiscard]] Eigen::Vector3d sizes_mm() const {
    return {bounds.sizes().x(), bounds.sizes().y(), heights_mm.back() - heights_mm.front()};
  }
};

/// @error those of make_section()
[[nodiscard]] Result<void> check_slices(std::span<const TrackedSlice> slices);

/// Index of the first slice that is turned by more than 1 degree against the first one, whichever way their normals
/// point; #slices if none is.
[[nodiscard]] std::size_t first_oblique(std::span<const TrackedSlice> slices);

/// A slice in a frame of the plane that it lies in, or nearly does: its points are projected there along z.
/// @error those of make_section(); invalid_argument (unknown parts): the message begins with `method`, has the slice's
///        number and says what takes it
[[nodiscard]] Result<Section> section_in(const Eigen::Isometry3d& plane_to_reference, const TrackedSlice& slice,
                                         std::size_t number, const std::string& method);

/// Normals may differ by 1 degree from the first slice's, and may point either way; slices are then taken as if
/// parallel.
/// @param method  its name in messages
/// @error invalid_argument (an oblique slice, fewer than two, two at one height, unknown parts; the message names the
///        live method as what takes them), empty_input (no contour), those of make_section()
[[nodiscard]] Result<SliceStack> make_stack(std::span<const TrackedSlice> slices, const std::string& method);

}  // namespace sonoloft
