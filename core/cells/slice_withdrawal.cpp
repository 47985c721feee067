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
  FacePolygon polygon = whole_section(store, section, work);
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

void remove_cells(CellStore& store, std::int32_t at, CellComplex::Withdrawal& withdrawal) {
  std::vector<std::int32_t> stack{at};
  while (!stack.empty()) {
    const std::int32_t node = stack.back();
    stack.pop_back();
    if (node >= 0) {
      const TreeNode& n = store.nodes[static_cast<std::size_t>(node)];
      withdrawal.slices.push_back(SliceId{store.plane_slices[n.plane]});
      stack.insert(stack.end(), {n.child[0], n.child[1]});
      continue;
    }
    Cell& cell = store.cells[static_cast<std::size_t>(~node)];
    for (const PolyFace& face : cell.shape.faces) store.release_wall(face.polygon);
    cell = Cell{};
    ++store.removed_cells;
    withdrawal.removed.push_back(CellId{static_cast<std::uint32_t>(~node)});
  }
}

/// What becomes of the box on the way down to a region.
struct Shaped {
  /// A step whose plane cuts a wall in two.
  struct Crossing {
    std::size_t step;
    std::uint32_t wall;  ///< that of the box, or kBoxWalls + the step that made it
  };
  Polyhedron shape;  ///< PolyFace::polygon is the wall
  std::vector<Crossing> crossings;
};

Shaped shape_of(const CellStore& store, const Region& region) {
  Shaped result{make_box(store.planes, store.scale), {}};
  for (PolyFace& face : result.shape.faces) face.polygon = face.plane;
  for (std::uint32_t step = 0; step < region.path.size(); ++step) {
    const auto [plane, branch] = region.path[step];
    const std::vector<std::int8_t> side = sides(store, result.shape, store.planes[plane]);
    for (const PolyFace& face : result.shape.faces)
      if (is_crossed(result.shape, face, side)) result.crossings.push_back({step, face.polygon});
    result.shape = part(result.shape, side, branch != 0 ? 1 : -1, store.planes, plane, store.scale);
    result.shape.faces.back().polygon = kBoxWalls + step;
  }
  return result;
}

/// The labels of a wall of the region.
FacePolygon wall_labels(const CellStore& store, const Region& region, std::span<const Shaped::Crossing> crossings,
                        const PolyFace& face, CellComplex::Work& work) {
  const std::uint32_t wall = face.polygon;
  FacePolygon polygon = wall < kBoxWalls ? store.box_wall(wall)
                                         : part_on(store, store.slices[store.plane_slices[face.plane]].section,
                                                   std::span(region.path).first(wall - kBoxWalls), work);
  for (const Shaped::Crossing& crossing : crossings) {
    const auto [plane, branch] = region.path[crossing.step];
    ImageLine line;
    if (crossing.wall != wall || !store.line_on(plane, store.frames[face.plane], line)) continue;
    auto halves = split(polygon, line);
    polygon = std::move(branch != 0 ? halves.second : halves.first);
  }
  return polygon;
}

/// The cell of a region before anything cut it, with walls of its own. Few slices on the way to it are still at its
/// walls: only these are clipped.
Cell restore(CellStore& store, const Region& region, CellComplex::Work& work) {
  auto [shape, crossings] = shape_of(store, region);
  Cell cell;
  for (PolyFace& face : shape.faces)
    face.polygon = store.add_wall(wall_labels(store, region, crossings, face, work), 1);
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
  result.regions = std::move(Search(store, held.plane).regions());
  for (Region& region : result.regions) {
    const std::uint8_t branch = region.path.empty() ? std::uint8_t{0} : region.path.back().branch;
    remove_cells(store, store.child(region.parent, branch), result);
    region.restored = CellId{static_cast<std::uint32_t>(store.cells.size())};
    store.cells.push_back(restore(store, region, result.work));
    store.child(region.parent, branch) = ~static_cast<std::int32_t>(region.restored);
  }
  store.recycle_walls();
  for (Cell& cell : store.cells) std::erase(cell.remembered, held.plane);
  std::ranges::sort(result.removed);
  std::ranges::sort(result.slices);
  result.slices.erase(std::ranges::unique(result.slices).begin(), result.slices.end());
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
