#include "core/cells/cell_store.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <span>
#include <utility>

#include "core/cells/plane_cut.h"
#include "core/cells/slice_cut.h"
#include "core/cells/slice_walk.h"

namespace sonoloft {
namespace {

constexpr std::size_t kMaxCells = std::size_t{1} << 22;

/// Frame of a box wall: origin in its corner, normal into the box.
Eigen::Isometry3d wall_frame(const Eigen::AlignedBox3d& box, std::uint32_t wall) {
  const int axis = static_cast<int>(wall / 2);
  const bool far = wall % 2 != 0;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis) * (far ? -1.0 : 1.0);
  const Eigen::Vector3d u = Eigen::Vector3d::Unit((axis + 1) % 3);
  frame.linear() << u, normal.cross(u), normal;
  frame.translation() = far ? box.max() : box.min();
  return frame;
}

Plane plane_of(const Eigen::Isometry3d& frame) {
  const Eigen::Vector3d normal = frame.linear().col(2);
  return {normal, -normal.dot(frame.translation())};
}

}  // namespace

Label uniform_label(const FacePolygon& polygon) {
  if (polygon.empty()) return kBeyondFace;
  const Label label = polygon.front().left;
  const bool uniform = std::all_of(polygon.begin(), polygon.end(),
                                   [&](const FaceEdge& e) { return e.left == label && e.right == kBeyondFace; });
  return uniform ? label : kBeyondFace;
}

FacePolygon rectangle(const Eigen::AlignedBox2d& r, Label label) {
  const Eigen::Vector2d p[4] = {r.min(), {r.max().x(), r.min().y()}, r.max(), {r.min().x(), r.max().y()}};
  FacePolygon polygon;
  for (int i = 0; i < 4; ++i) polygon.push_back({p[i], p[(i + 1) % 4], label, kBeyondFace});
  return polygon;
}

CellStore::CellStore(const Eigen::AlignedBox3d& box_mm, double gap_mm) : box(box_mm), min_gap_mm(gap_mm) {
  assert(!box.isEmpty() && box.sizes().minCoeff() > 0.0 && min_gap_mm > 0.0);
  scale = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  for (std::uint32_t wall = 0; wall < kBoxWalls; ++wall) {
    frames.push_back(wall_frame(box, wall));
    planes.push_back(plane_of(frames.back()));
    plane_slices.push_back(kNone);
  }
  Cell cell{};
  cell.shape = make_box(planes, scale);
  for (PolyFace& face : cell.shape.faces) face.polygon = add_wall(box_wall(face.plane), 1);
  cell.label = kOutside;
  cells.push_back(std::move(cell));
}

FacePolygon CellStore::box_wall(std::uint32_t wall) const {
  const Eigen::Isometry3d reference_to_image = frames[wall].inverse();
  Eigen::AlignedBox2d extent;
  for (int i = 0; i < 8; ++i)
    extent.extend((reference_to_image * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i))).head<2>());
  return rectangle(extent, kOutside);
}

std::uint32_t CellStore::add_wall(FacePolygon polygon, std::uint32_t users) {
  Wall wall{std::move(polygon), kBeyondFace, users};
  wall.label = uniform_label(wall.polygon);
  if (free_walls.empty()) {
    walls.push_back(std::move(wall));
    return static_cast<std::uint32_t>(walls.size() - 1);
  }
  const std::uint32_t index = free_walls.back();
  free_walls.pop_back();
  walls[index] = std::move(wall);
  return index;
}

void CellStore::release_wall(std::uint32_t wall) {
  assert(walls[wall].users > 0);
  if (--walls[wall].users == 0) released_walls.push_back(wall);
}

void CellStore::recycle_walls() {
  std::sort(released_walls.begin(), released_walls.end());
  const auto end = std::unique(released_walls.begin(), released_walls.end());
  for (const std::uint32_t wall : std::span(released_walls.begin(), end)) {
    if (walls[wall].users > 0) continue;  // taken again
    walls[wall] = Wall{};
    free_walls.push_back(wall);
  }
  released_walls.clear();
}

Label CellStore::label_of(const Polyhedron& shape) const {
  const Label label = walls[shape.faces.front().polygon].label;
  const bool same = std::all_of(shape.faces.begin(), shape.faces.end(),
                                [&](const PolyFace& face) { return walls[face.polygon].label == label; });
  return same && label != kUnknown ? label : kBeyondFace;
}

bool CellStore::line_on(std::uint32_t plane, const Eigen::Isometry3d& frame, ImageLine& line) const {
  const Eigen::Vector2d slope = (frame.linear().transpose() * planes[plane].normal).head<2>();
  const double length = slope.norm();
  line.offset_mm = planes[plane].distance(frame.translation());
  if (length < 1e-12) return false;
  line = {slope / length, line.offset_mm / length};
  return true;
}

CellId CellStore::locate(const Eigen::Vector3d& point_mm) const {
  std::int32_t node = root;
  while (node >= 0) {
    const TreeNode& n = nodes[static_cast<std::size_t>(node)];
    node = n.child[planes[n.plane].distance(point_mm) >= 0.0 ? 1 : 0];
  }
  return CellId{static_cast<std::uint32_t>(~node)};
}

Result<CellComplex::Delta> CellStore::insert(Section section, const CellComplex::PartWidth& width) {
  CellComplex::Delta delta;
  std::vector<Fragment> all;
  all.push_back({root, whole_section(*this, section, delta.work)});
  std::vector<Arrival> reached = walk(*this, section.image_to_reference, std::move(all), delta.work);
  if (reached.empty())
    return fail(ErrorCode::outside_box,
                "the slice does not reach the box of the scan: widen the box or check the pose");
  if (cells.size() >= kMaxCells)
    return fail(ErrorCode::cell_limit, "the scan has reached " + std::to_string(kMaxCells) +
                                           " cells: start a new scan, or use a narrower field of view");
  slices.push_back({std::move(section)});
  cut(static_cast<std::uint32_t>(slices.size() - 1), std::move(reached), width, delta);
  return delta;
}

void CellStore::cut(std::uint32_t slice, std::vector<Arrival> reached, const CellComplex::PartWidth& width,
                    CellComplex::Delta& delta) {
  HeldSlice& held = slices[slice];
  const bool known_plane = held.plane != kNone;
  if (!known_plane) {
    held.plane = static_cast<std::uint32_t>(planes.size());
    planes.push_back(plane_of(held.section.image_to_reference));
    frames.push_back(held.section.image_to_reference);
    plane_slices.push_back(slice);
  }
  delta.slice = SliceId{slice};
  delta.plane = PlaneId{held.plane};
  delta.reached = static_cast<std::uint32_t>(reached.size());
  SliceCut cut(*this, held.plane, delta);
  for (Arrival& arrival : reached) {
    const std::size_t before = cells.size();
    const CellId cell = arrival.cell;
    const double width_mm = width(cell);
    if (width_mm < std::numeric_limits<double>::infinity()) cut.cut(std::move(arrival), std::max(width_mm, min_gap_mm));
    if (cells.size() > before) delta.divided.push_back(cell);
  }
  recycle_walls();
  if (known_plane || cut.used_plane()) return;
  held.plane = kNone;
  planes.pop_back();
  frames.pop_back();
  plane_slices.pop_back();
}

}  // namespace sonoloft
