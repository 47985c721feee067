// CGAL's kernel and box intersection: slow to compile, so alone here.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>

#include "tests/support/mesh/mesh_check.h"

namespace sonoloft::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = std::array<std::uint32_t, 3>;

Point point(const Eigen::Vector3f& p) {
  return {static_cast<double>(p.x()), static_cast<double>(p.y()), static_cast<double>(p.z())};
}

/// Triangles with the edge (a, b) in common meet elsewhere exactly when they lie in one plane on one side of it.
bool folded(const Point& a, const Point& b, const Point& c, const Point& d) {
  return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
}

/// Triangles (a, b, c) and (a, d, e) with vertex a in common meet elsewhere exactly when an edge opposite of a meets
/// the other triangle.
bool meet_beyond(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e) {
  return CGAL::do_intersect(Kernel::Triangle_3(a, b, c), Kernel::Segment_3(d, e)) ||
         CGAL::do_intersect(Kernel::Triangle_3(a, d, e), Kernel::Segment_3(b, c));
}

bool meet(const IndexedMesh& mesh, Triangle s, Triangle t) {
  const auto at = [&](std::uint32_t v) { return point(mesh.positions[v]); };
  // Vertices in common to the front, in the same order.
  std::size_t common = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (const auto j = std::find(t.begin() + static_cast<long>(common), t.end(), s[i]); j != t.end()) {
      std::swap(s[common], s[i]);
      std::iter_swap(t.begin() + static_cast<long>(common), j);
      ++common;
    }
  if (common == 3) return true;
  if (common == 2) return folded(at(s[0]), at(s[1]), at(s[2]), at(t[2]));
  if (common == 1) return meet_beyond(at(s[0]), at(s[1]), at(s[2]), at(t[1]), at(t[2]));
  return CGAL::do_intersect(Kernel::Triangle_3(at(s[0]), at(s[1]), at(s[2])),
                            Kernel::Triangle_3(at(t[0]), at(t[1]), at(t[2])));
}

}  // namespace

bool on_one_line(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  return CGAL::collinear(point(a), point(b), point(c));
}

std::size_t count_self_intersections(const IndexedMesh& mesh) {
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;
  std::vector<Box> boxes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    CGAL::Bbox_3 box;
    for (const std::uint32_t v : mesh.triangles[t]) box += point(mesh.positions[v]).bbox();
    boxes.emplace_back(box, t);
  }
  std::size_t count = 0;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
    count += meet(mesh, mesh.triangles[a.info()], mesh.triangles[b.info()]);
  });
  return count;
}

}  // namespace sonoloft::test
