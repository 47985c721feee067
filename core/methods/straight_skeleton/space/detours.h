#pragma once
#include <span>

#include "core/methods/straight_skeleton/space/facet.h"

namespace sonoloft::skeleton {

/// How many of these facets lie where a front is the first by its distance, but could only have come through another
/// one: sharp corners of a patch run ahead of the front around them. In doubles: for a note, nothing depends on it.
/// @cost 32 places for a facet beyond a rim, each among the cells of fronts that are near
[[nodiscard]] std::size_t count_detours(const Space& space, std::span<const Facet* const> facets);

}  // namespace sonoloft::skeleton
