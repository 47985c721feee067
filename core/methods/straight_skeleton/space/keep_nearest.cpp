#include <algorithm>

#include "core/methods/straight_skeleton/space/facet.h"

namespace sonoloft::skeleton {
namespace {

/// Divides a facet by the cells of one front.
class Rival {
 public:
  Rival(const Space& space, std::uint32_t front) : front_(space.fronts[front]), box_(space.box) {}

  void pass(Facet&& facet, std::vector<Facet>& out) const {
    if (FormPtr whole = parting(facet.polygon); whole && !wins(facet)) {
      facet.off.push_back(std::move(whole));
      out.push_back(std::move(facet));
      return;
    }
    for (const FrontCell& cell : front_.cells) {
      if (!may_meet(facet.polygon, cell)) continue;
      Facet part = facet;
      if (!within(part.polygon, cell) || !farther(part, cell)) continue;
      part.off.insert(part.off.end(), cell.off.begin(), cell.off.end());
      out.push_back(std::move(part));
    }
  }

 private:
  /// A form that keeps all of a polygon off the patches, if there is one.
  FormPtr parting(const Polygon& polygon) const {
    for (const FrontCell& cell : front_.cells)
      if (cell.off.size() == 1 && std::ranges::all_of(polygon.corners, [&](const Corner& c) {
            return side_of(*cell.distance, c, box_.doubt_mm) >= 0;
          }))
        return cell.distance;
    return nullptr;
  }

  bool may_meet(const Polygon& polygon, const FrontCell& cell) const {
    RoughPolygon near(polygon, 2 * box_.doubt_mm);
    return std::ranges::all_of(cell.facets, [&](const FormPtr& f) { return near.cut(f->rough); });
  }

  /// Whether the front is nearer anywhere.
  bool wins(const Facet& facet) const {
    return std::ranges::any_of(front_.cells, [&](const FrontCell& cell) {
      RoughPolygon near(facet.polygon, 2 * box_.doubt_mm);
      if (!near.cut(facet.negative.distance().rough - cell.distance->rough)) return false;
      if (!std::ranges::all_of(cell.facets, [&](const FormPtr& f) { return near.cut(f->rough); })) return false;
      Polygon part = facet.polygon;
      const Cut by_distance = part.cut(difference(facet.negative.distance(), *cell.distance), box_.doubt_mm);
      return by_distance != Cut::none && within(part, cell);
    });
  }

  /// Of a polygon in a facet of cells each part goes to the one on its negative side.
  bool within(Polygon& polygon, const FrontCell& cell) const {
    for (const FormPtr& facet : cell.facets) {
      const Cut cut = polygon.cut(facet, box_.doubt_mm);
      if (cut == Cut::none) return false;
      if (cut == Cut::along && ratio_sign(*facet, *polygon.support) > 0) return false;
    }
    return true;
  }

  /// Keeps the part where neither owner is farther than the cell says.
  bool farther(Facet& facet, const FrontCell& cell) const {
    const FormPtr by = difference(*cell.distance, facet.negative.distance());
    const Cut cut = facet.polygon.cut(by, box_.doubt_mm);
    if (cut != Cut::along) return cut == Cut::some;
    return ratio_sign(*by, *facet.polygon.support) <= 0 &&
           ratio_sign(*difference(*cell.distance, facet.positive.distance()), *facet.polygon.support) >= 0;
  }

  const Front& front_;
  const ExactBox& box_;
};

}  // namespace

void keep_nearest(const Space& space, Facet facet, std::vector<Facet>& out) {
  facet.off = facet.negative.cell->off;
  if (facet.positive.cell != facet.negative.cell)
    facet.off.insert(facet.off.end(), facet.positive.cell->off.begin(), facet.positive.cell->off.end());
  std::vector<Facet> left, next;
  left.push_back(std::move(facet));
  for (std::uint32_t f = 0; f < space.fronts.size() && !left.empty(); ++f) {
    if (f == left.front().negative.front || f == left.front().positive.front) continue;
    const Rival rival(space, f);
    next.clear();
    for (Facet& part : left) rival.pass(std::move(part), next);
    std::swap(left, next);
  }
  std::ranges::move(left, std::back_inserter(out));
}

}  // namespace sonoloft::skeleton
