#pragma once
#include <utility>
#include <vector>

#include "core/slopes/slice_contours.h"

namespace sonoloft {

/// Slopes where the contours of two slices cross on walls, of either slice its own. Empty for planes that are nearly
/// parallel.
/// @param a, b  none of the two withdrawn
/// @cost O(edges near the planes' common line)
[[nodiscard]] std::pair<std::vector<Crossing>, std::vector<Crossing>> crossings_of(
    SliceId a, const SliceContours& contours_a, SliceId b, const SliceContours& contours_b, double feature_mm);

}  // namespace sonoloft
