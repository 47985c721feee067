#include "core/cells/slice_withdrawal.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/cells/plane_cut.h"
#include "core/cells/slice_walk.h"

namespace sonoloft {
namespace {

using Region = CellComplex::Withdrawal::Region;

/// What a slice has on the way down to a region, as far as the path goes. Empty when it ends before.
FacePolygon part_on(const CellStore& store, const Section& section, std::span<const Region::Step> path,
                    CellComplex::Work& work) {
  FacePolygon polygon = whole_section(store, section);
  for (const Region::Step& step : path) {
    if (polygon.empty()) break;
    polygon = std::move(parts_at(store, step.plane, section.image_to_reference, std::move(polygon), work)[step.branch]);
  }
  return polygon;
}

/// Goes through the tree for the places at which the slice's plane cut first.
class Search {
 public:
  Search(const CellStore& store, std::uint32_t plane) : store_(store), plane_(plane) { visit(store.root, kNone); }

  [[nodiscard]] std::vector<Region>& regions() { return regions_; }

 private:
  void visit(std::int32_t at, std::uint32_t parent) {
    if (at < 0) return;
    const auto node = static_cast<std::uint32_t>(at);
    if (store_.nodes[node].plane == plane_) {
      regions_.push_back({path_, parent, CellId{}});
      return;
    }
    for (const std::uint8_t branch : {std::uint8_t{0}, std::uint8_t{1}}) {
      path_.push_back({store_.nodes[node].plane, branch});
      visit(store_.nodes[node].child[branch], node);
      path_.pop_back();
    }
  }

  const CellStore& store_;
  std::uint32_t plane_;
  std::vector<Region::Step> path_;
  std::vector<Region> regions_;
};

void remove_cells(CellStore& store, std::int32_t at, std::vector<CellId>& removed) {
  std::vector<std::int32_t> stack{at};
  while (!stack.empty()) {
    const std::int32_t node = stack.back();
    stack.pop_back();
    if (node >= 0) {
      const TreeNode& n = store.nodes[static_cast<std::size_t>(node)];
      stack.insert(stack.end(), {n.child[0], n.child[1]});
      continue;
    }
    Cell& cell = store.cells[static_cast<std::size_t>(~node)];
    for (const PolyFace& face : cell.shape.faces) store.release_wall(face.polygon);
    cell = Cell{};
    ++store.removed_cells;
    removed.push_back(CellId{static_cast<std::uint32_t>(~node)});
  }
}

/// The cell of a region before anything cut it, with walls of its own.
Cell restore(CellStore& store, const Region& region, CellComplex::Work& work) {
  Polyhedron shape = make_box(store.planes, store.scale);
  std::vector<FacePolygon> polygons;  // [PolyFace::polygon]
  for (PolyFace& face : shape.faces) {
    face.polygon = static_cast<std::uint32_t>(polygons.size());
    polygons.push_back(store.box_wall(face.plane));
  }
  for (std::size_t n = 0; n < region.path.size(); ++n) {
    const auto [plane, branch] = region.path[n];
    const std::vector<std::int8_t> side = sides(store, shape, store.planes[plane]);
    for (const PolyFace& face : shape.faces) {
      ImageLine line;
      if (!is_crossed(shape, face, side) || !store.line_on(plane, store.frames[face.plane], line)) continue;
      auto halves = split(polygons[face.polygon], line);
      polygons[face.polygon] = std::move(branch != 0 ? halves.second : halves.first);
    }
    shape = part(shape, side, branch != 0 ? 1 : -1, store.planes, plane, store.scale);
    shape.faces.back().polygon = static_cast<std::uint32_t>(polygons.size());
    polygons.push_back(
        part_on(store, store.slices[store.plane_slices[plane]].section, std::span(region.path).first(n), work));
  }
  Cell cell;
  for (PolyFace& face : shape.faces) face.polygon = store.add_wall(std::move(polygons[face.polygon]), 1);
  cell.label = store.label_of(shape);
  cell.shape = std::move(shape);
  cell.node = region.parent;
  cell.branch = region.path.empty() ? std::uint8_t{0} : region.path.back().branch;
  return cell;
}

}  // namespace

CellComplex::Withdrawal withdraw(CellStore& store, std::uint32_t slice) {
  HeldSlice& held = store.slices[slice];
  held.withdrawn = true;
  CellComplex::Withdrawal result;
  if (held.plane == kNone) return result;
  CellComplex::Work work;
  result.regions = std::move(Search(store, held.plane).regions());
  for (Region& region : result.regions) {
    const std::uint8_t branch = region.path.empty() ? std::uint8_t{0} : region.path.back().branch;
    remove_cells(store, store.child(region.parent, branch), result.removed);
    region.restored = CellId{static_cast<std::uint32_t>(store.cells.size())};
    store.cells.push_back(restore(store, region, work));
    store.child(region.parent, branch) = ~static_cast<std::int32_t>(region.restored);
  }
  store.recycle_walls();
  for (Cell& cell : store.cells) std::erase(cell.remembered, held.plane);
  std::sort(result.removed.begin(), result.removed.end());
  return result;
}

CellComplex::Delta insert_again(CellStore& store, std::uint32_t slice, const CellComplex::Withdrawal& where,
                                const CellComplex::PartWidth& width) {
  CellComplex::Delta delta;
  const Section& section = store.slices[slice].section;
  std::vector<Fragment> fragments;
  for (const Region& region : where.regions) {
    const std::uint8_t branch = region.path.empty() ? std::uint8_t{0} : region.path.back().branch;
    fragments.push_back({store.child(region.parent, branch), part_on(store, section, region.path, delta.work)});
  }
  std::vector<Arrival> reached = walk(store, section.image_to_reference, std::move(fragments), delta.work);
  store.cut(slice, std::move(reached), width, delta);
  return delta;
}

}  // namespace sonoloft
