#include "core/cells/plane_cut.h"

#include <algorithm>
#include <utility>

namespace sonoloft {

namespace {

/// The outline of a face of a cell below it, in the image of its plane.
FacePolygon outline(const Polyhedron& shape, const PolyFace& face, const Eigen::Isometry3d& frame, Label label) {
  const Eigen::Isometry3d reference_to_image = frame.inverse();
  const auto corner = [&](std::uint32_t i) -> Eigen::Vector2d {
    return (reference_to_image * shape.vertices[shape.loops[face.first + i % face.count]].position).head<2>();
  };
  FacePolygon polygon;
  for (std::uint32_t i = 0; i < face.count; ++i) polygon.push_back({corner(i), corner(i + 1), label, kBeyondFace});
  return polygon;
}

}  // namespace

bool is_wide_enough(const Polyhedron& shape, const Plane& plane, double width_mm) {
  double lowest = 0.0;
  double highest = 0.0;
  for (const PolyVertex& v : shape.vertices) {
    lowest = std::min(lowest, plane.distance(v.position));
    highest = std::max(highest, plane.distance(v.position));
  }
  return lowest <= -width_mm && highest >= width_mm;
}

std::vector<std::int8_t> sides(const CellStore& store, const Polyhedron& shape, const Plane& plane) {
  if (!is_wide_enough(shape, plane, store.min_gap_mm)) return {};
  std::vector<std::int8_t> side;
  side.reserve(shape.vertices.size());
  for (const PolyVertex& v : shape.vertices)
    side.push_back(static_cast<std::int8_t>(side_of_plane(store.planes[v.planes[0]], store.planes[v.planes[1]],
                                                          store.planes[v.planes[2]], v.position, store.scale, plane)));
  const auto occurs = [&](int sign) { return std::find(side.begin(), side.end(), sign) != side.end(); };
  if (!occurs(-1) || !occurs(1)) return {};
  return side;
}

bool is_crossed(const Polyhedron& shape, const PolyFace& face, std::span<const std::int8_t> side) {
  bool below = false;
  bool above = false;
  for (std::uint32_t i = 0; i < face.count; ++i) {
    below |= side[shape.loops[face.first + i]] < 0;
    above |= side[shape.loops[face.first + i]] > 0;
  }
  return below && above;
}

CellId PlaneCut::cut(CellId cell, FacePolygon polygon, std::span<const std::int8_t> side) {
  return cut_in_two(cell, side, [&](const Polyhedron&) { return std::move(polygon); });
}

CellId PlaneCut::cut_uniform(CellId cell, std::span<const std::int8_t> side) {
  const Label label = store_.cells[static_cast<std::uint32_t>(cell)].label;
  return cut_in_two(cell, side, [&](const Polyhedron& below) {
    return outline(below, below.faces.back(), store_.frames[plane_], label);
  });
}

template <class MakePolygon>
CellId PlaneCut::cut_in_two(CellId id, std::span<const std::int8_t> side, const MakePolygon& make_polygon) {
  const auto lower_id = static_cast<std::uint32_t>(id);
  const auto upper_id = static_cast<std::uint32_t>(store_.cells.size());
  const Cell whole = std::move(store_.cells[lower_id]);
  split_walls(whole.shape, side);

  const auto node = static_cast<std::int32_t>(store_.nodes.size());
  Cell parts[2];
  for (int upper = 0; upper < 2; ++upper) {
    Cell& cell = parts[upper];
    cell.shape = part(whole.shape, side, upper != 0 ? 1 : -1, store_.planes, plane_, store_.scale);
    cell.node = static_cast<std::uint32_t>(node);
    cell.branch = static_cast<std::uint8_t>(upper);
  }
  const std::uint32_t wall = store_.add_wall(make_polygon(parts[0].shape), 2);
  for (Cell& cell : parts) cell.shape.faces.back().polygon = wall;
  pass_walls_on(whole.shape, parts);
  for (Cell& cell : parts) cell.label = store_.label_of(cell.shape);

  store_.nodes.push_back({plane_, {~static_cast<std::int32_t>(lower_id), ~static_cast<std::int32_t>(upper_id)}});
  store_.child(whole.node, whole.branch) = node;
  store_.cells[lower_id] = std::move(parts[0]);
  store_.cells.push_back(std::move(parts[1]));
  return CellId{upper_id};
}

/// The labelled faces that the cut crosses, each once for both cells at the wall.
void PlaneCut::split_walls(const Polyhedron& shape, std::span<const std::int8_t> side) {
  for (const PolyFace& face : shape.faces) {
    if (!is_crossed(shape, face, side) || halves_.contains(face.polygon)) continue;
    const FacePolygon& polygon = store_.walls[face.polygon].polygon;
    ++work_.faces_cut;
    work_.edges_clipped += static_cast<std::uint32_t>(polygon.size());
    ImageLine line;
    const bool crosses = store_.line_on(plane_, store_.frames[face.plane], line);
    auto halves = crosses ? split(polygon, line) : std::pair<FacePolygon, FacePolygon>{polygon, {}};
    const std::uint32_t low = store_.add_wall(std::move(halves.first), 0);
    const std::uint32_t high = store_.add_wall(std::move(halves.second), 0);
    halves_[face.polygon] = {low, high};
  }
}

/// Gives the faces of the parts their halves of the walls. Only faces with vertices on both sides were split; one that
/// merely touches the cut moves as it is.
void PlaneCut::pass_walls_on(const Polyhedron& whole, Cell (&parts)[2]) {
  for (const PolyFace& face : whole.faces) {
    const auto halves = halves_.find(face.polygon);
    bool used = false;
    for (int upper = 0; upper < 2; ++upper)
      for (PolyFace& f : parts[upper].shape.faces) {
        if (f.plane != face.plane || f.polygon != face.polygon) continue;
        if (halves != halves_.end()) {
          f.polygon = upper != 0 ? halves->second.second : halves->second.first;
          ++store_.walls[f.polygon].users;
        } else {
          used = true;
        }
        break;
      }
    if (!used) store_.release_wall(face.polygon);
  }
}

}  // namespace sonoloft
