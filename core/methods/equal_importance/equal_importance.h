#pragma once
// slices of a stack, along a curve or about an axis -> [EQUAL IMPORTANCE] -> surfaces
#include <span>

#include "core/methods/method.h"

namespace sonoloft {

/// How contours are joined.
enum class ContourForm : std::uint8_t {
  dense,   ///< signed distances, blended linearly: for slices that lie near each other
  sparse,  ///< between contours that lie one within the other, by shares whose gradient keeps its size on the way from
           ///< the one to the other: for few, such as those of a map
};

struct EqualImportanceOptions {
  double spacing_mm = 0;  ///< edge of a finest cell; > 0
  ContourForm form = ContourForm::dense;
  int threads = 1;
};

/// Every contour counts the same at every point between it and the next one. Slices lie in a stack, along a curve or
/// about an axis; the last two are seen as a stack, too. Every label by itself; the one that holds a point deepest has
/// it. Stacks and curves are closed flat at their ends. Frame: reference, mm. Threads: any; nothing is shared.
/// @error those of chart_of() and mesh_of()
/// @cost  O(#labels * #nodes of the box); sparse also sweeps, see equal_shares()
/// Source: Cong, Parvin 2001, Robust and efficient surface reconstruction from contours.
[[nodiscard]] Result<MethodSurfaces> equal_importance(std::span<const TrackedSlice> slices,
                                                      const EqualImportanceOptions& options);

/// The same by its name; option "form".
[[nodiscard]] Method equal_importance_method();

}  // namespace sonoloft
