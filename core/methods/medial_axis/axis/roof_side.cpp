#include "core/methods/medial_axis/axis/roof_side.h"

#include <algorithm>

namespace sonoloft::medial {

RoofSide roof_side(const CellAxis& axis, std::uint32_t ridge, std::uint32_t face, double margin_mm) {
  const Ridge& r = axis.ridges[ridge];
  RoofSide side{ridge, axis.vertices[r.p].foot(face), axis.vertices[r.q].foot(face), {}};
  side.box.extend(rounded(side.p)).extend(rounded(side.q));
  side.box.min().array() -= margin_mm;
  side.box.max().array() += margin_mm;
  return side;
}

std::vector<RoofSide> roof_sides(const CellAxis& axis, std::uint32_t face, double margin_mm) {
  std::vector<std::uint32_t> ridges;
  for (const std::uint32_t s : axis.roofs[face])
    for (const std::uint32_t r : axis.sheets[s].sides)
      if (!axis.ridges[r].edge) ridges.push_back(r);
  std::ranges::sort(ridges);
  ridges.erase(std::unique(ridges.begin(), ridges.end()), ridges.end());
  std::vector<RoofSide> sides;
  for (const std::uint32_t r : ridges) sides.push_back(roof_side(axis, r, face, margin_mm));
  return sides;
}

}  // namespace sonoloft::medial
