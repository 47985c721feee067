#pragma once
#include <Eigen/Core>

namespace sonoloft {

/// How the surface leaves its slice at a point of a contour. Seen from a point at the height h over the slice, counted
/// along the slice's normal, the contour's point lies displaced by about
///   (2 * slope * h + curvature * h^2) / (2 + (fading * h)^4) * outward
/// in the plane of the slice; the field damps the slope too (core/kernels/field_sum.h). To turn outward, slope and
/// curvature round says the same. Zeros: the point stays.
struct VertexBend {
  Eigen::Vector2f outward = Eigen::Vector2f::Zero();  ///< normal of the contour, length 1; image frame
  float slope = 0;                                    ///< of the surface: how far it goes outward per height
  float curvature_per_mm = 0;                         ///< of the contour, > 0 where it is convex seen from outward
  float fading_per_mm = 0;                            ///< beyond one over this height they say no more

  friend bool operator==(const VertexBend&, const VertexBend&) = default;
};

}  // namespace sonoloft
