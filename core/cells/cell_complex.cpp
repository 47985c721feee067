#include "core/cells/cell_complex.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/cells/polyhedron.h"

namespace sonoloft {
namespace {

constexpr std::size_t kMaxCells = std::size_t{1} << 22;
constexpr std::uint32_t kBoxWalls = 6;

/// A node of the tree of planes; a negative child is the leaf of cell ~child.
struct Node {
  std::uint32_t plane;
  std::int32_t child[2];  ///< below, above
};

struct Cell {
  Polyhedron shape;
  std::uint32_t node;   ///< of the tree, under which this cell hangs ...
  std::uint8_t branch;  ///< ... on this side; both meaningless for the only cell of an uncut box
};

/// The labels of a face. Both cells at a wall refer to one polygon until one of them is cut there and the other is not.
struct Wall {
  FacePolygon polygon;
  Label label = kBeyondFace;
  std::uint32_t users = 0;
};

/// A slice on its way down the tree.
struct Fragment {
  std::int32_t node;
  FacePolygon polygon;
};

Label uniform_label(const FacePolygon& polygon) {
  if (polygon.empty()) return kBeyondFace;
  const Label label = polygon.front().left;
  const bool uniform = std::all_of(polygon.begin(), polygon.end(),
                                   [&](const FaceEdge& e) { return e.left == label && e.right == kBeyondFace; });
  return uniform ? label : kBeyondFace;
}

bool has_known_part(const FacePolygon& polygon) {
  return std::any_of(polygon.begin(), polygon.end(), [](const FaceEdge& e) {
    return e.left != kUnknown || (e.right != kUnknown && e.right != kBeyondFace);
  });
}

/// A rectangle of one label, counter-clockwise.
FacePolygon rectangle(const Eigen::AlignedBox2d& r, Label label) {
  const Eigen::Vector2d p[4] = {r.min(), {r.max().x(), r.min().y()}, r.max(), {r.min().x(), r.max().y()}};
  FacePolygon polygon;
  for (int i = 0; i < 4; ++i) polygon.push_back({p[i], p[(i + 1) % 4], label, kBeyondFace});
  return polygon;
}

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

struct CellComplex::Impl {
  Eigen::AlignedBox3d box;
  double min_gap_mm = 0.0;
  double scale = 0.0;  ///< upper bound of coordinates, for rounding bounds
  std::vector<Plane> planes;
  std::vector<Eigen::Isometry3d> frames;  ///< [plane]
  std::vector<Node> nodes;
  std::vector<Cell> cells;
  std::vector<Wall> walls;
  std::vector<std::uint32_t> free_walls;

  std::uint32_t add_wall(FacePolygon polygon, std::uint32_t users);
  void release_wall(std::uint32_t wall);
  [[nodiscard]] bool line_on(std::uint32_t plane, const Eigen::Isometry3d& frame, ImageLine& line) const;
  [[nodiscard]] FacePolygon whole_section(const Section& section) const;
  [[nodiscard]] std::vector<std::pair<CellId, FacePolygon>> reach(const Section& section) const;
  [[nodiscard]] bool sides(const Polyhedron& shape, const Plane& plane, std::vector<std::int8_t>& side) const;
  void cut(CellId cell, std::uint32_t plane, FacePolygon polygon, std::span<const std::int8_t> side,
           std::unordered_map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>>& split_walls);
};

std::uint32_t CellComplex::Impl::add_wall(FacePolygon polygon, std::uint32_t users) {
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

void CellComplex::Impl::release_wall(std::uint32_t wall) {
  assert(walls[wall].users > 0);
  if (--walls[wall].users > 0) return;
  walls[wall] = Wall{};
  free_walls.push_back(wall);
}

/// Where a plane meets the plane of a frame, in that frame's image; false when they are parallel.
bool CellComplex::Impl::line_on(std::uint32_t plane, const Eigen::Isometry3d& frame, ImageLine& line) const {
  const Eigen::Vector2d slope = (frame.linear().transpose() * planes[plane].normal).head<2>();
  const double length = slope.norm();
  line.offset_mm = planes[plane].distance(frame.translation());
  if (length < 1e-12) return false;
  line = {slope / length, line.offset_mm / length};
  return true;
}

/// The section as one labelled polygon that fills the box's cross-section.
FacePolygon CellComplex::Impl::whole_section(const Section& section) const {
  const Eigen::Isometry3d reference_to_image = section.image_to_reference.inverse();
  Eigen::AlignedBox2d extent;
  for (int i = 0; i < 8; ++i)
    extent.extend((reference_to_image * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i))).head<2>());
  for (const Eigen::Vector2d& p : section.points) extent.extend(p);
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.01 * extent.diagonal().norm());
  FacePolygon polygon = rectangle({extent.min() - margin, extent.max() + margin}, section.border);
  polygon.reserve(polygon.size() + section.edges.size());
  for (const SectionEdge& e : section.edges)
    polygon.push_back({section.points[e.a], section.points[e.b], e.left, e.right});
  for (std::uint32_t wall = 0; wall < kBoxWalls; ++wall) {
    ImageLine line;
    if (line_on(wall, section.image_to_reference, line))
      polygon = split(polygon, line).second;
    else if (line.offset_mm < 0.0)
      return {};
  }
  return polygon;
}

/// Sends the section down the tree; what arrives in a leaf with a known part has reached that cell.
std::vector<std::pair<CellId, FacePolygon>> CellComplex::Impl::reach(const Section& section) const {
  std::vector<std::pair<CellId, FacePolygon>> reached;
  std::vector<Fragment> stack;
  stack.push_back({nodes.empty() ? ~0 : 0, whole_section(section)});
  while (!stack.empty()) {
    Fragment fragment = std::move(stack.back());
    stack.pop_back();
    if (!has_known_part(fragment.polygon)) continue;
    if (fragment.node < 0) {
      reached.emplace_back(CellId{static_cast<std::uint32_t>(~fragment.node)}, std::move(fragment.polygon));
      continue;
    }
    const Node& node = nodes[static_cast<std::size_t>(fragment.node)];
    ImageLine line;
    const bool crosses = line_on(node.plane, section.image_to_reference, line);
    bool below = line.offset_mm < 0.0;
    bool above = !below;
    if (crosses) {
      below = above = false;
      for (const FaceEdge& e : fragment.polygon) (line.distance(e.a) < 0.0 ? below : above) = true;
    }
    if (below && above) {
      auto [lower, upper] = split(fragment.polygon, line);
      stack.push_back({node.child[0], std::move(lower)});
      stack.push_back({node.child[1], std::move(upper)});
    } else {
      stack.push_back({node.child[above ? 1 : 0], std::move(fragment.polygon)});
    }
  }
  std::sort(reached.begin(), reached.end(), [](const auto& l, const auto& r) { return l.first < r.first; });
  return reached;
}

/// On which side of `plane` each vertex lies, exactly; false when the cell is not to be cut there.
bool CellComplex::Impl::sides(const Polyhedron& shape, const Plane& plane, std::vector<std::int8_t>& side) const {
  double lowest = 0.0;
  double highest = 0.0;
  for (const PolyVertex& v : shape.vertices) {
    lowest = std::min(lowest, plane.distance(v.position));
    highest = std::max(highest, plane.distance(v.position));
  }
  if (lowest > -min_gap_mm || highest < min_gap_mm) return false;
  side.clear();
  for (const PolyVertex& v : shape.vertices)
    side.push_back(static_cast<std::int8_t>(
        side_of_plane(planes[v.planes[0]], planes[v.planes[1]], planes[v.planes[2]], v.position, scale, plane)));
  return std::find(side.begin(), side.end(), -1) != side.end() && std::find(side.begin(), side.end(), 1) != side.end();
}

void CellComplex::Impl::cut(CellId id, std::uint32_t plane, FacePolygon polygon, std::span<const std::int8_t> side,
                            std::unordered_map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>>& split_walls) {
  const std::uint32_t lower_id = static_cast<std::uint32_t>(id);
  const auto upper_id = static_cast<std::uint32_t>(cells.size());
  const Cell whole = std::move(cells[lower_id]);

  // The labelled faces that the cut crosses, split once for both cells at the wall.
  for (const PolyFace& face : whole.shape.faces) {
    bool below = false;
    bool above = false;
    for (std::uint32_t i = 0; i < face.count; ++i) {
      below |= side[whole.shape.loops[face.first + i]] < 0;
      above |= side[whole.shape.loops[face.first + i]] > 0;
    }
    if (!below || !above || split_walls.contains(face.polygon)) continue;
    ImageLine line;
    const bool crosses = line_on(plane, frames[face.plane], line);
    auto halves = crosses ? split(walls[face.polygon].polygon, line)
                          : std::pair<FacePolygon, FacePolygon>{walls[face.polygon].polygon, {}};
    const std::uint32_t low = add_wall(std::move(halves.first), 0);
    const std::uint32_t high = add_wall(std::move(halves.second), 0);
    split_walls[face.polygon] = {low, high};
  }

  const std::uint32_t wall = add_wall(std::move(polygon), 2);
  const auto node = static_cast<std::int32_t>(nodes.size());
  Cell parts[2];
  for (int upper = 0; upper < 2; ++upper) {
    Cell& cell = parts[upper];
    cell.shape = part(whole.shape, side, upper != 0 ? 1 : -1, planes, plane, scale);
    cell.node = static_cast<std::uint32_t>(node);
    cell.branch = static_cast<std::uint8_t>(upper);
    cell.shape.faces.back().polygon = wall;
  }
  for (const PolyFace& face : whole.shape.faces) {
    const auto halves = split_walls.find(face.polygon);
    bool used = false;
    for (int upper = 0; upper < 2; ++upper)
      for (PolyFace& f : parts[upper].shape.faces) {
        if (f.plane != face.plane || f.polygon != face.polygon) continue;
        // Only faces with vertices on both sides were split; one that merely touches the cut moves as it is.
        if (halves != split_walls.end()) {
          f.polygon = upper != 0 ? halves->second.second : halves->second.first;
          ++walls[f.polygon].users;
        } else {
          used = true;
        }
        break;
      }
    if (!used) release_wall(face.polygon);
  }

  nodes.push_back({plane, {~static_cast<std::int32_t>(lower_id), ~static_cast<std::int32_t>(upper_id)}});
  if (node > 0) nodes[whole.node].child[whole.branch] = node;
  cells[lower_id] = std::move(parts[0]);
  cells.push_back(std::move(parts[1]));
}

CellComplex::CellComplex(const Eigen::AlignedBox3d& box, double min_gap_mm) : impl_(std::make_unique<Impl>()) {
  assert(!box.isEmpty() && box.sizes().minCoeff() > 0.0 && min_gap_mm > 0.0);
  impl_->box = box;
  impl_->min_gap_mm = min_gap_mm;
  impl_->scale = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  for (std::uint32_t wall = 0; wall < kBoxWalls; ++wall) {
    impl_->frames.push_back(wall_frame(box, wall));
    impl_->planes.push_back(plane_of(impl_->frames.back()));
  }
  Cell cell{};
  cell.shape = make_box(impl_->planes, impl_->scale);
  for (PolyFace& face : cell.shape.faces) {
    Eigen::AlignedBox2d extent;
    for (std::uint32_t i = 0; i < face.count; ++i) {
      const Eigen::Vector3d& corner = cell.shape.vertices[cell.shape.loops[face.first + i]].position;
      extent.extend((impl_->frames[face.plane].inverse() * corner).head<2>());
    }
    face.polygon = impl_->add_wall(rectangle(extent, kOutside), 1);
  }
  impl_->cells.push_back(std::move(cell));
}

CellComplex::~CellComplex() = default;
CellComplex::CellComplex(CellComplex&&) noexcept = default;
CellComplex& CellComplex::operator=(CellComplex&&) noexcept = default;

Result<CellComplex::Delta> CellComplex::insert(const Section& section) {
  Impl& impl = *impl_;
  auto reached = impl.reach(section);
  if (reached.empty())
    return fail(ErrorCode::outside_box,
                "the slice does not reach the box of the scan: widen the box or check the pose");
  Delta delta;
  delta.plane = PlaneId{static_cast<std::uint32_t>(impl.planes.size())};
  delta.reached = static_cast<std::uint32_t>(reached.size());
  const Plane plane = plane_of(section.image_to_reference);

  std::vector<std::pair<std::size_t, std::vector<std::int8_t>>> cuts;
  std::vector<std::int8_t> side;
  for (std::size_t i = 0; i < reached.size(); ++i)
    if (impl.sides(impl.cells[static_cast<std::uint32_t>(reached[i].first)].shape, plane, side))
      cuts.emplace_back(i, side);
  if (cuts.empty())
    return fail(ErrorCode::duplicate_plane,
                "the slice lies in the plane of an earlier one, which is kept: nothing to do");
  if (impl.cells.size() + cuts.size() > kMaxCells)
    return fail(ErrorCode::cell_limit, "the scan has reached " + std::to_string(kMaxCells) +
                                           " cells: start a new scan, or use a narrower field of view");

  impl.planes.push_back(plane);
  impl.frames.push_back(section.image_to_reference);
  std::unordered_map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> split_walls;
  for (auto& [index, cell_side] : cuts) {
    delta.lower.push_back(reached[index].first);
    delta.upper.push_back(CellId{static_cast<std::uint32_t>(impl.cells.size())});
    impl.cut(reached[index].first, static_cast<std::uint32_t>(delta.plane), std::move(reached[index].second), cell_side,
             split_walls);
  }
  return delta;
}

std::size_t CellComplex::cell_count() const {
  return impl_->cells.size();
}
std::size_t CellComplex::face_count() const {
  return impl_->walls.size() - impl_->free_walls.size();
}
const Eigen::AlignedBox3d& CellComplex::box() const {
  return impl_->box;
}

std::size_t CellComplex::edge_count() const {
  return std::accumulate(impl_->walls.begin(), impl_->walls.end(), std::size_t{0},
                         [](std::size_t sum, const Wall& w) { return sum + w.polygon.size(); });
}

void CellComplex::faces(CellId cell, std::vector<CellFace>& out) const {
  out.clear();
  for (const PolyFace& f : impl_->cells[static_cast<std::uint32_t>(cell)].shape.faces) {
    const Wall& wall = impl_->walls[f.polygon];
    out.push_back({&impl_->frames[f.plane], PlaneId{f.plane}, f.above, wall.label, &wall.polygon});
  }
}

Eigen::AlignedBox3d CellComplex::bounds(CellId cell) const {
  Eigen::AlignedBox3d box;
  for (const PolyVertex& v : impl_->cells[static_cast<std::uint32_t>(cell)].shape.vertices) box.extend(v.position);
  return box;
}

Eigen::Vector3d CellComplex::centre(CellId cell) const {
  return sonoloft::centre(impl_->cells[static_cast<std::uint32_t>(cell)].shape);
}

double CellComplex::volume(CellId cell) const {
  return sonoloft::volume(impl_->cells[static_cast<std::uint32_t>(cell)].shape);
}

CellId CellComplex::locate(const Eigen::Vector3d& point) const {
  std::int32_t node = impl_->nodes.empty() ? ~0 : 0;
  while (node >= 0) {
    const Node& n = impl_->nodes[static_cast<std::size_t>(node)];
    node = n.child[impl_->planes[n.plane].distance(point) >= 0.0 ? 1 : 0];
  }
  return CellId{static_cast<std::uint32_t>(~node)};
}

void CellComplex::locate(const Eigen::AlignedBox3d& bounds, std::span<const Eigen::Vector3d> points,
                         std::vector<std::uint32_t>& order, std::vector<CellPoints>& groups) const {
  const Eigen::Vector3d middle = bounds.center();
  const Eigen::Vector3d reach = 0.5 * bounds.sizes() + Eigen::Vector3d::Constant(1e-9 * impl_->scale);
  struct Job {
    std::int32_t node;
    std::uint32_t first, last;
  };
  order.resize(points.size());
  std::iota(order.begin(), order.end(), 0u);
  groups.clear();
  std::vector<Job> stack{{impl_->nodes.empty() ? ~0 : 0, 0, static_cast<std::uint32_t>(points.size())}};
  while (!stack.empty()) {
    Job job = stack.back();
    stack.pop_back();
    while (job.node >= 0 && job.first < job.last) {
      const Node& n = impl_->nodes[static_cast<std::size_t>(job.node)];
      const Plane& plane = impl_->planes[n.plane];
      const double s = plane.distance(middle);
      const double r = plane.normal.cwiseAbs().dot(reach);
      if (s > r || s < -r) {
        job.node = n.child[s > 0.0 ? 1 : 0];
        continue;
      }
      const auto begin = order.begin() + job.first;
      const auto above = std::partition(begin, order.begin() + job.last,
                                        [&](std::uint32_t i) { return plane.distance(points[i]) < 0.0; });
      const auto split_at = job.first + static_cast<std::uint32_t>(above - begin);
      stack.push_back({n.child[1], split_at, job.last});
      job = {n.child[0], job.first, split_at};
    }
    if (job.first < job.last)
      groups.push_back({CellId{static_cast<std::uint32_t>(~job.node)}, job.first, job.last - job.first});
  }
}

std::string CellComplex::validate() const {
  const double tolerance = 1e-10 * impl_->scale;
  double sum = 0.0;
  std::vector<std::uint32_t> users(impl_->walls.size(), 0);
  for (std::size_t c = 0; c < impl_->cells.size(); ++c) {
    const Polyhedron& shape = impl_->cells[c].shape;
    const std::string where = "cell " + std::to_string(c) + ": ";
    if (std::string wrong = sonoloft::validate(shape, impl_->planes, tolerance); !wrong.empty()) return where + wrong;
    sum += sonoloft::volume(shape);
    for (const PolyFace& f : shape.faces) ++users[f.polygon];
    // A cell thinner than the rounding of coordinates has no double inside that could be looked for.
    const Eigen::Vector3d middle = sonoloft::centre(shape);
    const bool thick = std::all_of(shape.faces.begin(), shape.faces.end(), [&](const PolyFace& f) {
      return std::abs(impl_->planes[f.plane].distance(middle)) > tolerance;
    });
    if (thick && locate(middle) != CellId{static_cast<std::uint32_t>(c)})
      return where + "the tree does not lead to its centre";
  }
  for (std::size_t w = 0; w < users.size(); ++w)
    if (users[w] != impl_->walls[w].users || users[w] > 2)
      return "wall " + std::to_string(w) + ": wrong count of users";
  if (std::abs(sum - impl_->box.volume()) > 1e-9 * impl_->box.volume()) return "volumes do not add up to the box";
  return {};
}

}  // namespace sonoloft
