#pragma once
#include <Eigen/Core>
#include <vector>

#include "core/slopes/contour/arcs.h"

namespace sonoloft {

/// The contours of a slice as they bend in its plane. Frame: image.
struct ArcShape {
  std::vector<Eigen::Vector2f> outward;  ///< [#places] normal, length 1, towards the smaller label; 0 where a contour
                                         ///< turns back on itself
  std::vector<float> curvature_per_mm;   ///< [#places] > 0 where the greater label is convex; 0 of what is no surface
};

/// Tangents from three chords around each place, weighted by their order, and curvature from how they turn; towards the
/// ends of an open arc windows end with it.
/// @cost O(#places)
[[nodiscard]] ArcShape shape_of(const Section& section, const Arcs& arcs, double feature_mm);

}  // namespace sonoloft
