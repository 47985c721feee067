#pragma once
// slices of any direction that saw a part of their planes -> [STRAIGHT SKELETON] -> surfaces
#include <span>

#include "core/methods/network/contour_surfaces.h"

namespace sonoloft {

struct StraightSkeletonOptions {
  bool fairing = true;  ///< between the slices smooth, else walls and flat sheets
  int threads = 1;      ///< >= 1; the result does not depend on it
};

/// What a slice knows is a patch: its plane, or the part within its field of view less the unknown parts. From all
/// patches fronts go through space at equal speed: up and down, and sideways from rims, in planes orthogonal to the
/// patch. Every point has the label of the front that arrives first, and that is the one of the point of the patch that
/// the front's way leads down to: upright, and from beyond a rim perpendicular to it. Where two labels meet there is
/// the surface. With full planes it is the surface of medial_axis(). Everything is decided exactly, coordinates are
/// rounded at the end.
/// @post  every label is closed: no edge of its boundary has more triangles on one side than on the other
/// @error those of make_section(); empty_input; too_large
/// @cost  see docs/methods/straight-skeleton.md
/// Threads: any; nothing is shared.
/// Source: Barequet, Vaxman 2009, Reconstruction of multi-label domains from partial planar cross-sections.
[[nodiscard]] Result<ContourSurfaces> straight_skeleton(std::span<const TrackedSlice> slices,
                                                        const StraightSkeletonOptions& options);

/// The same by its name; option "fairing".
[[nodiscard]] Method straight_skeleton_method();

}  // namespace sonoloft
