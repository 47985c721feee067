#pragma once
// slices of any direction -> [MEDIAL AXIS] -> surfaces
#include <span>

#include "core/methods/network/contour_surfaces.h"

namespace sonoloft {

struct MedialAxisOptions {
  bool fairing = true;  ///< between the slices smooth, else walls and flat sheets
  int threads = 1;      ///< >= 1; the result does not depend on it
};

/// The planes of the slices cut space into convex cells; every point of a cell has the label of the nearest face of the
/// cell at its foot there. Where two labels meet there is the surface: upright on the contours, and flat half-way
/// between two faces, on the cell's medial axis. Every edge of a contour, cut where other slices cross it, is an edge
/// of the surface, and nothing else of it lies on a slice but where two slices contradict each other on their common
/// line. Planes in any direction, any number of labels. Everything is decided exactly, coordinates are rounded at the
/// end.
/// @post  every label is closed: no edge of its boundary has more triangles on one side than on the other
/// @error those of make_section(); invalid_argument (unknown parts, planes that nearly coincide); empty_input;
///        too_large; cell_limit
/// @cost  0.03 to 0.2 ms a point of the contours; fairing the same again or some times that: it adds triangles
/// Threads: any; nothing is shared.
/// Source: Liu, Bajaj, Deasy, Low, Ju 2008, Surface reconstruction from non-parallel curve networks, section 4.
[[nodiscard]] Result<ContourSurfaces> medial_axis(std::span<const TrackedSlice> slices,
                                                  const MedialAxisOptions& options);

/// The same by its name; option "fairing".
[[nodiscard]] Method medial_axis_method();

}  // namespace sonoloft
