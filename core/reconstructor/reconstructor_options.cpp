#include "core/reconstructor/reconstructor_options.h"

#include <cassert>
#include <cmath>

namespace sonoloft {
namespace {

/// Chunk keys hold 2^18 lattice points to either side.
constexpr double kMaxLatticePoints = 1 << 18;
/// Finer backgrounds, as a share of the box, are slow and say no more.
constexpr double kFinestBackground = 1e-3;
constexpr double kBackgroundNodes = 64;  ///< in an object, for recorded slices

}  // namespace

Result<void> check(const ReconstructorOptions& o) {
  if (o.box.isEmpty() || !o.box.min().allFinite() || !o.box.max().allFinite() || o.box.sizes().minCoeff() <= 0.0)
    return fail(ErrorCode::invalid_argument, "the box of the scan is empty or not finite: give its two corners in mm");
  if (!(o.spacing_mm > 0.0) || !std::isfinite(o.spacing_mm))
    return fail(ErrorCode::invalid_argument, "the spacing must be a positive number of mm");
  if (o.box.sizes().maxCoeff() / o.spacing_mm > kMaxLatticePoints)
    return fail(ErrorCode::invalid_argument,
                "the box is more than 2^18 spacings long: use a wider spacing or a smaller box");
  if (!(o.background_mm >= kFinestBackground * o.box.sizes().maxCoeff()) || !std::isfinite(o.background_mm))
    return fail(ErrorCode::invalid_argument,
                "the background's spacing must be a number of mm, at least 1e-3 of the longest side of the box");
  if (o.completion == Completion::published && o.admission != Admission::everything)
    return fail(ErrorCode::invalid_argument, "the published completion is for Admission::everything");
  if (o.hops && *o.hops < 1) return fail(ErrorCode::invalid_argument, "hops must be at least 1");
  if (o.threads < 1) return fail(ErrorCode::invalid_argument, "threads must be at least 1");
  return {};
}

Result<ReconstructorOptions> options_for(std::span<const TrackedSlice> slices, int depth) {
  assert(depth >= 2 && depth <= 12);
  Eigen::AlignedBox3d extent;
  for (const TrackedSlice& slice : slices)
    for (const Contour& contour : slice.contours)
      for (std::uint32_t i = 0; i < contour.count; ++i) {
        const Eigen::Vector2d& p = slice.points[contour.first + i];
        extent.extend(slice.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0.0));
      }
  if (extent.isEmpty() || extent.sizes().maxCoeff() <= 0.0)
    return fail(ErrorCode::empty_input, "no slice has a contour: there is nothing to reconstruct");
  const double longest = extent.sizes().maxCoeff();
  ReconstructorOptions options;
  options.box = {extent.min() - Eigen::Vector3d::Constant(longest), extent.max() + Eigen::Vector3d::Constant(longest)};
  options.spacing_mm = 1.1 * longest / std::exp2(depth);
  options.background_mm = 1.1 * longest / kBackgroundNodes;
  options.admission = Admission::everything;
  return options;
}

}  // namespace sonoloft
