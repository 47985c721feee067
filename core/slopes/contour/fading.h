#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/slopes/contour/arc_shape.h"
#include "core/slopes/contour/border_tree.h"

namespace sonoloft {

/// VertexBend::fading_per_mm: from which height on a contour says no more. By itself a contour bulges by up to
/// 0.35 / curvature on its convex side; where another border is nearer there, only so far that both keep apart, since
/// two fingers side by side are two fingers between the slices too.
/// @param is_station  [#places] where it is computed; linear in between
/// @return [#places] one over mm
/// @cost   O(#stations log #edges)
[[nodiscard]] std::vector<float> fading_of(const Section& section, const Arcs& arcs, const ArcShape& shape,
                                           std::span<const std::uint8_t> is_station, const BorderTree& borders,
                                           double feature_mm);

}  // namespace sonoloft
