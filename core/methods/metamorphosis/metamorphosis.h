#pragma once
// parallel slices -> [METAMORPHOSIS] -> surfaces
#include <span>

#include "core/methods/method.h"

namespace sonoloft {

/// What becomes of the first and the last slice of a stack.
enum class StackEnds : std::uint8_t {
  flat,   ///< the surface ends there, closed flat: for a contour that the user knows to be the last
  round,  ///< the contours run on as they came and close half-way to where the next slice would have been
};

struct MetamorphosisOptions {
  double spacing_mm = 0;  ///< edge of a finest cell; > 0
  StackEnds ends = StackEnds::round;
  int threads = 1;
};

/// One contour becomes the next: the front between two slices runs along its normal as a level set, and its way is
/// spread over the height between them by monotone cubics, so that the surface runs smoothly through the slices and
/// nowhere beyond what they say. Every label by itself against the rest; where two claim a point the one that holds it
/// deeper has it. Parts that overlap nothing in the next slice are closed half-way there, and noted.
/// Frame: reference, mm. Threads: any; nothing is shared.
/// @error those of make_stack() and mesh_of()
/// @cost  O(#labels * (#slices * #nodes of a slice + nodes that fronts sweep * layers)): 35 slices of 420 x 300 nodes
///        in seconds
/// Source: Nilsson, Breen, Museth 2005, Surface reconstruction via contour metamorphosis.
[[nodiscard]] Result<MethodSurfaces> metamorphosis(std::span<const TrackedSlice> slices,
                                                   const MetamorphosisOptions& options);

/// The same by its name; option "ends".
[[nodiscard]] Method metamorphosis_method();

}  // namespace sonoloft
