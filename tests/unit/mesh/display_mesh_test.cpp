#include "core/mesh/display/display_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "core/mesh/surface_extractor.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/synthetic_lattice.h"

namespace sonoloft::test {
namespace {

IndexedMesh mesh_of(int labels, const ShareField& field) {
  const SyntheticLattice lattice(48, labels, field);
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), 2);
  return extractor.snapshot().indexed();
}

std::set<std::pair<Label, Label>> label_pairs(const IndexedMesh& mesh) {
  std::set<std::pair<Label, Label>> pairs;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) pairs.emplace(mesh.label_front[t], mesh.label_back[t]);
  return pairs;
}

std::size_t non_manifold_edges(const IndexedMesh& mesh) {
  std::size_t count = 0;
  for (const auto& [label, report] : check_mesh(mesh).labels) count += report.non_manifold_edges;
  return count;
}

/// Three spheres that meet in lines, and a small one by itself.
const IndexedMesh& spheres() {
  static const IndexedMesh mesh =
      mesh_of(5, spheres_field({{{18, 20, 20}, 12.0}, {{30, 20, 20}, 11.0}, {{24, 30, 22}, 10.0}, {{8, 40, 40}, 2.5}}));
  return mesh;
}

}  // namespace

TEST_CASE("display: a tenth of the triangles stays within the stated error of a sphere") {
  const Eigen::Vector3d centre(24, 24, 24);
  const IndexedMesh mesh = mesh_of(2, sphere_field(centre, 18));
  const DisplayMesh display = simplify_for_display(mesh, mesh.triangles.size() / 10);
  CHECK(display.mesh.triangles.size() <= mesh.triangles.size() / 10);
  CHECK(display.mesh.triangles.size() > mesh.triangles.size() / 12);
  CHECK(display.error_mm < 0.5);
  double farthest = 0;
  for (const auto& [a, b, c] : display.mesh.triangles) {
    const auto& p = display.mesh.positions;
    const Eigen::Vector3d middle = (p[a] + p[b] + p[c]).cast<double>() / 3;
    farthest = std::max(farthest, std::abs((middle - centre).norm() - 18));
  }
  MESSAGE("error " << display.error_mm << ", centroids " << farthest << " off");
  CHECK(farthest < 2 * display.error_mm + 0.05);  // the error is an estimate, and the mesh itself is a little off
  CHECK(check_mesh(display.mesh).degenerate_triangles == 0);
}

TEST_CASE("display: every surface between two labels is still there, and every vertex is one of the original") {
  for (const std::size_t triangles :
       {spheres().triangles.size() / 2, spheres().triangles.size() / 20, std::size_t{1}}) {
    const DisplayMesh display = simplify_for_display(spheres(), triangles);
    CHECK(label_pairs(display.mesh) == label_pairs(spheres()));
    CHECK(display.mesh.triangles.size() < spheres().triangles.size());
    const auto less = [](const Eigen::Vector3f& l, const Eigen::Vector3f& r) {
      return std::lexicographical_compare(l.begin(), l.end(), r.begin(), r.end());
    };
    std::set<Eigen::Vector3f, decltype(less)> known(spheres().positions.begin(), spheres().positions.end(), less);
    for (const Eigen::Vector3f& p : display.mesh.positions) CHECK(known.contains(p));
  }
}

TEST_CASE("display: surfaces still fit together where labels meet, and at half the triangles stay manifold") {
  REQUIRE(check_mesh(spheres()).closed_manifold());
  for (const std::size_t part : {2, 4, 10}) {
    const DisplayMesh display = simplify_for_display(spheres(), spheres().triangles.size() / part);
    std::size_t open = 0;
    for (const auto& [label, report] : check_mesh(display.mesh).labels) open += report.boundary_edges;
    MESSAGE("1/" << part << ": " << display.mesh.triangles.size() << " triangles, error " << display.error_mm << ", "
                 << non_manifold_edges(display.mesh) << " edges not manifold");
    CHECK(open == 0);
    if (part == 2) CHECK(non_manifold_edges(display.mesh) == 0);
  }
}

TEST_CASE("display: a mesh that is small enough, or empty, stays as it is") {
  const DisplayMesh same = simplify_for_display(spheres(), spheres().triangles.size());
  CHECK(same.mesh.triangles.size() == spheres().triangles.size());
  CHECK(same.error_mm == 0);
  CHECK(simplify_for_display({}, 10).mesh.triangles.empty());
}

}  // namespace sonoloft::test
