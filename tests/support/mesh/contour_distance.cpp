#include "tests/support/mesh/contour_distance.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>

namespace sonoloft::test {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

Triangles triangles_of(const IndexedMesh& mesh) {
  Triangles triangles;
  const auto corner = [&](std::uint32_t v) { return point(mesh.positions[v].cast<double>()); };
  for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(corner(a), corner(b), corner(c));
  return triangles;
}

}  // namespace

std::vector<double> distances(std::span<const Eigen::Vector3d> points_mm, const IndexedMesh& mesh) {
  const Triangles triangles = triangles_of(mesh);
  Tree tree(triangles.begin(), triangles.end());
  tree.accelerate_distance_queries();
  std::vector<double> result;
  for (const Eigen::Vector3d& p : points_mm) result.push_back(std::sqrt(tree.squared_distance(point(p))));
  return result;
}

std::vector<double> contour_distances(std::span<const TrackedSlice> slices, const IndexedMesh& mesh) {
  std::vector<Eigen::Vector3d> points_mm;
  for (const TrackedSlice& slice : slices)
    for (const Contour& contour : slice.contours)
      for (std::uint32_t i = contour.first; i < contour.first + contour.count; ++i)
        points_mm.push_back(slice.image_to_reference * Eigen::Vector3d(slice.points[i].x(), slice.points[i].y(), 0.0));
  return distances(points_mm, mesh);
}

}  // namespace sonoloft::test
