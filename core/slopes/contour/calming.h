#pragma once
#include "core/slopes/contour/arcs.h"

namespace sonoloft {

/// A section whose contours are calmed within their own noise: what tangents, curvatures and slopes are taken from,
/// while the field passes through the contours as they are. The noise of an arc is measured: by how far its points lie
/// beside the cubic through the two points before and after each. A point goes to the line that fits those around it
/// best, over 16 times the noise, and at most three times the noise far: points that lie farther apart stay, to the
/// last bit. Ends of open arcs stay, and what is no surface.
/// @param arcs  of the section
/// @cost  O(#points * points of an arc within 16 times its noise)
[[nodiscard]] Section calmed(Section section, const Arcs& arcs, double feature_mm);

}  // namespace sonoloft
