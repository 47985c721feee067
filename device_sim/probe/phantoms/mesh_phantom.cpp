#include "device_sim/probe/phantoms/mesh_phantom.h"

#include <algorithm>
#include <string>
#include <utility>

namespace sonoloft::device_sim {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

constexpr std::uint32_t next_corner(std::uint32_t half_edge) {
  return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}
std::uint32_t vertex(const Triangles& triangles, std::uint32_t half_edge) {
  return triangles[half_edge / 3][half_edge % 3];
}

double six_volumes(const std::vector<Eigen::Vector3d>& p, const Triangles& triangles) {
  double sum = 0;
  for (const auto& t : triangles) sum += (p[t[1]] - p[0]).cross(p[t[2]] - p[0]).dot(p[t[0]] - p[0]);
  return sum;
}

std::string check_numbers(const std::vector<Eigen::Vector3d>& positions, const Triangles& triangles, Label label) {
  if (label == kOutside || label >= kFirstReservedLabel) return "mesh: the label must be a material, 1 to 65520";
  if (triangles.empty()) return "mesh: it has no triangles; give a closed surface";
  if (triangles.size() > (1u << 28)) return "mesh: over 2^28 triangles; simplify it";
  for (const Eigen::Vector3d& p : positions)
    if (!p.allFinite()) return "mesh: a position is not a finite number; repair the file";
  for (const auto& t : triangles)
    for (const std::uint32_t v : t)
      if (v >= positions.size()) return "mesh: a triangle names vertex " + std::to_string(v) + ", which is not there";
  return {};
}

/// Pairs the half-edges. @error empty where an edge has not exactly two triangles that run it in opposite directions
std::vector<std::uint32_t> pair_half_edges(const Triangles& triangles) {
  struct Entry {
    std::uint64_t edge;  // smaller vertex, larger vertex
    std::uint32_t half_edge;
    bool along;  // from smaller to larger
  };
  std::vector<Entry> entries;
  entries.reserve(3 * triangles.size());
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    const std::uint64_t a = vertex(triangles, h), b = vertex(triangles, next_corner(h));
    entries.push_back({std::min(a, b) << 32 | std::max(a, b), h, a < b});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::pair(a.edge, a.half_edge) < std::pair(b.edge, b.half_edge);
  });
  std::vector<std::uint32_t> twins(entries.size());
  if (entries.size() % 2 != 0) return {};
  for (std::size_t i = 0; i < entries.size(); i += 2) {
    const Entry &a = entries[i], &b = entries[i + 1];
    if (a.edge != b.edge || a.along == b.along) return {};
    if (i + 2 < entries.size() && entries[i + 2].edge == a.edge) return {};
    twins[a.half_edge] = b.half_edge;
    twins[b.half_edge] = a.half_edge;
  }
  return twins;
}

/// Makes the points from `first` on a loop, unless the plane only touched an edge or a vertex.
void close_loop(PhantomSection& section, std::size_t first, Label label) {
  std::vector<Eigen::Vector2d>& points = section.points;
  while (points.size() > first + 1 && points.back() == points[first]) points.pop_back();
  const std::size_t count = points.size() - first;
  const double area = count < 3 ? 0 : signed_area({&points[first], count});
  if (area == 0) return points.resize(first);
  const bool hole = area < 0;
  section.loops.push_back(
      {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), hole ? kOutside : label, hole});
}

}  // namespace

Made<MeshPhantom> MeshPhantom::make(std::vector<Eigen::Vector3d> positions_mm,
                                    std::vector<std::array<std::uint32_t, 3>> triangles, Label label) {
  std::string error = check_numbers(positions_mm, triangles, label);
  if (!error.empty()) return {nullptr, std::move(error)};
  const double volume = six_volumes(positions_mm, triangles);
  if (volume == 0) return {nullptr, "mesh: it encloses no volume; give a closed surface"};
  if (volume < 0)
    for (auto& t : triangles) std::swap(t[1], t[2]);
  std::vector<std::uint32_t> twins = pair_half_edges(triangles);
  if (twins.empty())
    return {nullptr, "mesh: an edge has not exactly two triangles of the same winding; close and orient the surface"};
  std::unique_ptr<MeshPhantom> mesh(new MeshPhantom);
  for (const auto& t : triangles)
    for (const std::uint32_t v : t) mesh->bounds_.extend(positions_mm[v]);
  mesh->positions_ = std::move(positions_mm);
  mesh->triangles_ = std::move(triangles);
  mesh->twins_ = std::move(twins);
  mesh->label_ = label;
  return {std::move(mesh), {}};
}

double MeshPhantom::volume_mm3() const {
  return six_volumes(positions_, triangles_) / 6;
}

PhantomSection MeshPhantom::section(const Eigen::Isometry3d& plane_to_reference) const {
  const Eigen::Isometry3d reference_to_plane = plane_to_reference.inverse();
  std::vector<double> height(positions_.size());
  const Eigen::Vector3d normal = plane_to_reference.linear().col(2);
  const double offset = reference_to_plane.translation().z();
  for (std::size_t v = 0; v < positions_.size(); ++v) height[v] = normal.dot(positions_[v]) + offset;
  const auto above = [&](std::uint32_t half_edge) { return height[vertex(triangles_, half_edge)] >= 0; };
  const auto climb = [&](std::uint32_t half_edge) -> Eigen::Vector2d {
    const std::uint32_t low = vertex(triangles_, half_edge), high = vertex(triangles_, next_corner(half_edge));
    const double t = height[low] / (height[low] - height[high]);
    return (reference_to_plane * (positions_[low] + t * (positions_[high] - positions_[low]))).head<2>();
  };

  PhantomSection section;
  std::vector<char> seen(triangles_.size(), 0);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const int corners_above = above(3 * t) + above(3 * t + 1) + above(3 * t + 2);
    if (seen[t] || corners_above == 0 || corners_above == 3) continue;
    const std::size_t first = section.points.size();
    // Each crossed triangle has one edge that climbs through the plane and one that falls: leave by the climbing one,
    // which falls in its neighbour. Seen against the normal of the plane, the inside is on the left.
    for (std::uint32_t at = t; !seen[at];) {
      seen[at] = 1;
      std::uint32_t leave = 3 * at;
      while (above(leave) || !above(next_corner(leave))) ++leave;
      const Eigen::Vector2d p = climb(leave);
      if (section.points.size() == first || p != section.points.back()) section.points.push_back(p);
      at = twins_[leave] / 3;
    }
    close_loop(section, first, label_);
  }
  return section;
}

Label MeshPhantom::label_at(const Eigen::Vector3d& point_mm) const {
  const PhantomSection cut = section(Eigen::Isometry3d(Eigen::Translation3d(point_mm)));  // the point is its origin
  bool inside = false;
  for (const SectionLoop& loop : cut.loops) {
    for (std::uint32_t i = 0; i < loop.count; ++i) {
      const Eigen::Vector2d& a = cut.points[loop.first + i];
      const Eigen::Vector2d& b = cut.points[loop.first + (i + 1) % loop.count];
      if ((a.y() > 0) != (b.y() > 0) && a.x() + (b.x() - a.x()) * a.y() / (a.y() - b.y()) > 0) inside = !inside;
    }
  }
  return inside ? label_ : kOutside;
}

}  // namespace sonoloft::device_sim
