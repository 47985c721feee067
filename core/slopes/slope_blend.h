#pragma once
#include "core/slopes/slice_contours.h"

namespace sonoloft {

/// Computes the slopes of arcs that are stale from crossings and planes, and the bends of all points.
/// @cost O(places of stale arcs + points)
void blend(SliceContours& contours, double feature_mm);

}  // namespace sonoloft
