#include <algorithm>
#include <span>

#include "core/methods/straight_skeleton/space/facet.h"

namespace sonoloft::skeleton {
namespace {

/// Of the box: what meets by less than this is worth exact arithmetic.
constexpr double kSlack = 1e-7;

/// Whether a polygon lies in a cell, and on that side of its plane, where it lies in a facet of the cell.
bool clip(Polygon& polygon, const FrontCell& cell, int side, double doubt_mm) {
  for (const FormPtr& facet : cell.facets) {
    const Cut cut = polygon.cut(facet, doubt_mm);
    if (cut == Cut::none) return false;
    if (cut == Cut::along && ratio_sign(*facet, *polygon.support) != side) return false;
  }
  return true;
}

bool may_meet(RoughPolygon& near, std::span<const FormPtr> planes) {
  return std::ranges::all_of(planes, [&](const FormPtr& f) { return near.cut(f->rough); });
}

/// A side of one footing that runs along a side of another one, from outside.
FormPtr common_side(const Footing& f, const Footing& g) {
  for (const FormPtr& side : f.outline.sides)
    for (const FormPtr& other : g.outline.sides)
      if (side->rough.dot(other->rough) < 0 && ratio_sign(*side, *other) < 0) return side;
  return nullptr;
}

}  // namespace

std::vector<Facet> sheets(const Space& space, const Owner& of) {
  std::vector<Facet> out;
  const FrontCell& cell = *of.cell;
  const ExactBox& box = space.box;
  const double slack_mm = kSlack * box.box.diagonal().norm();
  for (std::uint32_t g = of.front + 1; g < space.fronts.size(); ++g)
    for (const FrontCell& other : space.fronts[g].cells) {
      const Eigen::Vector4d between = cell.distance->rough - other.distance->rough;
      if (between.head<3>().norm() == 0) continue;
      RoughPolygon near(box.box, between, slack_mm);
      if (!may_meet(near, cell.facets) || !may_meet(near, other.facets) || !may_meet(near, box.walls)) continue;
      const FormPtr support = difference(*cell.distance, *other.distance);
      Polygon polygon = Polygon::across(box, support);
      if (polygon.empty() || !clip(polygon, cell, -1, box.doubt_mm) || !clip(polygon, other, 1, box.doubt_mm)) continue;
      keep_nearest(space, {std::move(polygon), of, {g, &other}}, out);
    }
  return out;
}

std::vector<Facet> uprights(const Space& space, const Owner& of) {
  std::vector<Facet> out;
  const ExactBox& box = space.box;
  const Front& front = space.fronts[of.front];
  const Footing& footing = front.footings[of.cell->footing];
  for (const Curve& curve : footing.curves) {
    RoughPolygon near(box.box, curve.line->rough, kSlack * box.box.diagonal().norm());
    if (!may_meet(near, of.cell->facets) || !may_meet(near, curve.ends) || !may_meet(near, box.walls)) continue;
    Polygon polygon = Polygon::across(box, curve.line);
    for (const FormPtr& end : curve.ends)
      if (!polygon.empty()) polygon.cut(end, box.doubt_mm);
    if (!polygon.empty() && clip(polygon, *of.cell, 0, box.doubt_mm))
      keep_nearest(space, {std::move(polygon), of, of, &curve}, out);
  }
  for (const FrontCell& other : front.cells) {
    if (other.footing <= of.cell->footing) continue;
    const FormPtr side = common_side(footing, front.footings[other.footing]);
    if (!side) continue;
    Polygon polygon = Polygon::across(box, negative(*side));
    if (!polygon.empty() && clip(polygon, *of.cell, -1, box.doubt_mm) && clip(polygon, other, 1, box.doubt_mm))
      keep_nearest(space, {std::move(polygon), of, {of.front, &other}}, out);
  }
  return out;
}

}  // namespace sonoloft::skeleton
