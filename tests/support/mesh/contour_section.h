#pragma once
#include <map>
#include <span>
#include <string>

#include "core/methods/medial_axis/medial_axis.h"

namespace sonoloft::test {

/// How the surfaces meet the slices, and whether they close.
struct ContourSection {
  std::size_t open_edges = 0;  ///< with more triangles of some label on one side than on the other
  std::size_t crossings = 0;   ///< triangles with corners on both sides of a slice's plane
  std::size_t strays = 0;      ///< edges on a slice, seen from either of its sides, that are no piece of a contour
                               ///< of these labels
  double missing = 0;          ///< of the contours' length no edge of the surfaces, the worse of both sides
  double distance = 0;         ///< largest distance of such an edge from its contour, of the data's diagonal
  [[nodiscard]] bool exact() const;
  [[nodiscard]] std::string text() const;
};

/// Looks at positions and labels only: what lies within 10^-9 of the diagonal of a plane lies on it. Where a slice says
/// unknown nothing is looked at.
[[nodiscard]] ContourSection section_with(std::span<const TrackedSlice> slices, const ContourSurfaces& surfaces);

/// What each label encloses.
[[nodiscard]] std::map<Label, double> volumes_mm3(const ContourSurfaces& surfaces);

}  // namespace sonoloft::test
