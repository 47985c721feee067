#include "tests/support/mesh/mesh_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>
#include <unordered_map>

namespace sonoloft::test {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Sets that grow together.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<std::size_t> parent_;
};

struct EdgeUse {
  std::uint64_t edge;  ///< smaller vertex << 32 | larger vertex
  std::uint32_t triangle;
  bool forward;  ///< from the smaller to the larger vertex
};

std::vector<EdgeUse> sorted_edges(const std::vector<Triangle>& triangles) {
  std::vector<EdgeUse> uses;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t a = triangles[t][i], b = triangles[t][(i + 1) % 3];
      uses.push_back({std::min(a, b) << 32 | std::max(a, b), t, a < b});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.edge, a.triangle) < std::tie(b.edge, b.triangle);
  });
  return uses;
}

std::size_t corner_at(const Triangle& triangle, std::uint64_t vertex) {
  return static_cast<std::size_t>(std::find(triangle.begin(), triangle.end(), vertex) - triangle.begin());
}

/// Vertices whose corners fall into more than one group when corners of triangles with a common edge are joined.
std::size_t count_split_vertices(const std::vector<Triangle>& triangles, Groups& corners) {
  std::vector<std::pair<std::uint32_t, std::size_t>> fans;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) fans.emplace_back(triangles[t][i], corners.of(3 * t + i));
  std::sort(fans.begin(), fans.end());
  fans.erase(std::unique(fans.begin(), fans.end()), fans.end());
  std::size_t split = 0;
  for (std::size_t i = 1; i < fans.size(); ++i)
    split += fans[i].first == fans[i - 1].first && (i < 2 || fans[i - 2].first != fans[i].first);
  return split;
}

double volume(const IndexedMesh& mesh, const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return 0;
  const Eigen::Vector3d origin = mesh.positions[triangles[0][0]].cast<double>();
  const auto at = [&](std::uint32_t v) { return Eigen::Vector3d(mesh.positions[v].cast<double>() - origin); };
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += at(a).dot(at(b).cross(at(c)));
  return sum / 6;
}

LabelReport check_label(const IndexedMesh& mesh, Label label) {
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (mesh.label_back[t] == label) triangles.push_back({a, b, c});
    if (mesh.label_front[t] == label) triangles.push_back({a, c, b});
  }
  LabelReport report;
  report.triangles = triangles.size();
  report.volume_mm3 = volume(mesh, triangles);
  Groups corners(3 * triangles.size()), pieces(triangles.size());
  const std::vector<EdgeUse> uses = sorted_edges(triangles);
  std::size_t edges = 0;
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last, ++edges) {
    while (last < uses.size() && uses[last].edge == uses[first].edge) ++last;
    report.boundary_edges += last - first == 1;
    report.non_manifold_edges += last - first > 2;
    report.misoriented_edges += last - first == 2 && uses[first].forward == uses[first + 1].forward;
    for (std::size_t i = first + 1; i < last; ++i) {
      const std::size_t s = uses[first].triangle, t = uses[i].triangle;
      pieces.join(s, t);
      for (const std::uint64_t vertex : {uses[i].edge >> 32, uses[i].edge & 0xFFFFFFFF})
        corners.join(3 * s + corner_at(triangles[s], vertex), 3 * t + corner_at(triangles[t], vertex));
    }
  }
  report.non_manifold_vertices = count_split_vertices(triangles, corners);
  std::set<std::uint32_t> vertices;
  for (const Triangle& t : triangles) vertices.insert(t.begin(), t.end());
  for (std::size_t t = 0; t < triangles.size(); ++t) report.components += pieces.of(t) == t;
  report.euler = static_cast<long>(vertices.size()) - static_cast<long>(edges) + static_cast<long>(triangles.size());
  return report;
}

}  // namespace

// Exact, in mesh_intersections.cpp.
bool on_one_line(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);

MeshReport check_mesh(const IndexedMesh& mesh) {
  MeshReport report;
  std::vector<char> used(mesh.positions.size(), 0);
  std::set<Label> labels;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    const bool bad = std::any_of(triangle.begin(), triangle.end(), [&](auto v) { return v >= mesh.positions.size(); });
    report.bad_indices += bad;
    if (bad) continue;
    for (const std::uint32_t v : triangle) used[v] = 1;
    report.degenerate_triangles +=
        on_one_line(mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]);
    report.same_label_triangles += mesh.label_front[t] == mesh.label_back[t];
    labels.insert({mesh.label_front[t], mesh.label_back[t]});
  }
  report.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
  if (report.bad_indices == 0)
    for (const Label label : labels) report.labels[label] = check_label(mesh, label);
  return report;
}

bool MeshReport::closed_manifold() const {
  return degenerate_triangles + bad_indices + unused_vertices + same_label_triangles == 0 &&
         std::all_of(labels.begin(), labels.end(), [](const auto& entry) { return entry.second.closed_manifold(); });
}

std::string MeshReport::text() const {
  std::ostringstream out;
  out << "degenerate " << degenerate_triangles << ", bad indices " << bad_indices << ", unused vertices "
      << unused_vertices << ", same label " << same_label_triangles;
  for (const auto& [label, r] : labels) {
    out << "\n  label " << label << ": " << r.triangles << " triangles, " << r.components << " components, genus "
        << r.genus() << ", volume " << r.volume_mm3 << " mm3; edges: boundary " << r.boundary_edges << ", non-manifold "
        << r.non_manifold_edges << ", misoriented " << r.misoriented_edges << "; vertices: non-manifold "
        << r.non_manifold_vertices;
  }
  return out.str();
}

std::vector<double> smallest_angles_deg(const IndexedMesh& mesh) {
  std::vector<double> result;
  for (const Triangle& triangle : mesh.triangles) {
    double smallest = 180;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = [&](std::size_t k) { return Eigen::Vector3d(mesh.positions[triangle[k % 3]].cast<double>()); };
      const Eigen::Vector3d a = at(i + 1) - at(i), b = at(i + 2) - at(i);
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI);
    }
    result.push_back(smallest);
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace sonoloft::test
