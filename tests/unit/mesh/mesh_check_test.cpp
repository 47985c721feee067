#include "tests/support/mesh/mesh_check.h"

#include <doctest/doctest.h>

#include <cmath>

// A checker that finds nothing proves nothing: each fault is put in here and must be found.
namespace sonoloft::test {
namespace {

void add(IndexedMesh& mesh, std::array<std::uint32_t, 3> triangle, Label front = 0, Label back = 1) {
  mesh.triangles.push_back(triangle);
  mesh.label_front.push_back(front);
  mesh.label_back.push_back(back);
}

/// A tetrahedron of volume 1/6, moved.
void add_tetrahedron(IndexedMesh& mesh, const Eigen::Vector3f& at = Eigen::Vector3f::Zero()) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, 0, 1)})
    mesh.positions.push_back(p + at);
  for (const auto& [a, b, c] : {std::array{0u, 2u, 1u}, {0u, 1u, 3u}, {0u, 3u, 2u}, {1u, 2u, 3u}})
    add(mesh, {first + a, first + b, first + c});
}

IndexedMesh tetrahedron() {
  IndexedMesh mesh;
  add_tetrahedron(mesh);
  return mesh;
}

IndexedMesh torus(std::uint32_t around, std::uint32_t across) {
  IndexedMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / across, r = 3 + std::cos(v);
      mesh.positions.emplace_back(Eigen::Vector3d(r * std::cos(u), r * std::sin(u), std::sin(v)).cast<float>());
      const auto at = [&](std::uint32_t di, std::uint32_t dj) {
        return (i + di) % around * across + (j + dj) % across;
      };
      add(mesh, {at(0, 0), at(1, 0), at(1, 1)});
      add(mesh, {at(0, 0), at(1, 1), at(0, 1)});
    }
  return mesh;
}

TEST_CASE("mesh check: a tetrahedron and a torus are sound, with their volume and genus") {
  const MeshReport report = check_mesh(tetrahedron());
  CHECK(report.closed_manifold());
  CHECK(report.labels.at(1).volume_mm3 == doctest::Approx(1.0 / 6));
  CHECK(report.labels.at(0).volume_mm3 == doctest::Approx(-1.0 / 6));
  CHECK(report.labels.at(1).genus() == 0);
  CHECK(count_self_intersections(tetrahedron()) == 0);
  const IndexedMesh ring = torus(60, 40);
  CHECK(check_mesh(ring).closed_manifold());
  CHECK(check_mesh(ring).labels.at(1).genus() == 1);
  CHECK(check_mesh(ring).labels.at(1).components == 1);
  CHECK(check_mesh(ring).labels.at(1).volume_mm3 == doctest::Approx(2 * M_PI * M_PI * 3).epsilon(0.01));
  CHECK(count_self_intersections(ring) == 0);
}

TEST_CASE("mesh check: finds a hole, a turned triangle, an unused vertex and bad indices") {
  IndexedMesh hole = tetrahedron();
  hole.triangles.pop_back();
  CHECK(check_mesh(hole).labels.at(1).boundary_edges == 3);
  IndexedMesh turned = tetrahedron();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  CHECK(check_mesh(turned).labels.at(1).misoriented_edges == 3);
  IndexedMesh unused = tetrahedron();
  unused.positions.emplace_back(5, 5, 5);
  CHECK(check_mesh(unused).unused_vertices == 1);
  IndexedMesh bad = tetrahedron();
  bad.triangles[0][0] = 99;
  CHECK(check_mesh(bad).bad_indices == 1);
  IndexedMesh same = tetrahedron();
  same.label_front[0] = 1;
  CHECK(check_mesh(same).same_label_triangles == 1);
  for (const IndexedMesh& mesh : {hole, turned, unused, bad, same}) CHECK_FALSE(check_mesh(mesh).closed_manifold());
}

TEST_CASE("mesh check: finds an edge of four triangles and a vertex of two fans") {
  IndexedMesh edge = tetrahedron();  // a second one on the edge 0-1
  edge.positions.emplace_back(0, -1, 0);
  edge.positions.emplace_back(0, 0, -1);
  for (const auto& t : {std::array{0u, 4u, 1u}, {0u, 1u, 5u}, {0u, 5u, 4u}, {1u, 4u, 5u}}) add(edge, t);
  CHECK(check_mesh(edge).labels.at(1).non_manifold_edges == 1);
  IndexedMesh vertex = tetrahedron();  // a second one on the vertex 0
  for (const Eigen::Vector3f& p : {Eigen::Vector3f(-1, 0, 0), Eigen::Vector3f(0, -1, 0), Eigen::Vector3f(0, 0, -1)})
    vertex.positions.push_back(p);
  for (const auto& t : {std::array{0u, 4u, 5u}, {0u, 6u, 4u}, {0u, 5u, 6u}, {4u, 6u, 5u}}) add(vertex, t);
  CHECK(check_mesh(vertex).labels.at(1).non_manifold_edges == 0);
  CHECK(check_mesh(vertex).labels.at(1).non_manifold_vertices == 1);
}

TEST_CASE("mesh check: finds triangles without area, by index, by position and on one line") {
  for (const Eigen::Vector3f& third : {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(0.5F, 0, 0)}) {
    IndexedMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, third};
    add(mesh, {0, 1, 2});
    CHECK(check_mesh(mesh).degenerate_triangles == 1);
  }
  IndexedMesh repeated = tetrahedron();
  repeated.triangles[0] = {1, 1, 2};
  CHECK(check_mesh(repeated).degenerate_triangles == 1);
}

TEST_CASE("mesh check: finds triangles that meet apart from what they share, and no others") {
  const auto pairs = [](std::vector<Eigen::Vector3f> positions, std::array<std::uint32_t, 3> second) {
    IndexedMesh mesh;
    mesh.positions = std::move(positions);
    add(mesh, {0, 1, 2});
    add(mesh, second);
    return count_self_intersections(mesh);
  };
  const Eigen::Vector3f a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  CHECK(pairs({a, b, c, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}}, {3, 4, 5}) == 1);  // pierces
  CHECK(pairs({a, b, c, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, {3, 4, 5}) == 1);   // lies within
  CHECK(pairs({a, b, c, {9, 9, -1}, {9, 9, 1}, {8, 8, 1}}, {3, 4, 5}) == 0);  // apart
  CHECK(pairs({a, b, c, {1, 1, -1}, {1, 1, 1}}, {0, 3, 4}) == 1);             // one vertex, pierces
  CHECK(pairs({a, b, c, {-1, -1, -1}, {-1, -1, 1}}, {0, 3, 4}) == 0);         // one vertex, on the other side
  CHECK(pairs({a, b, c, {1, 1, 1}}, {1, 0, 3}) == 0);                         // one edge, at an angle
  CHECK(pairs({a, b, c, {1, 1, 0}}, {1, 0, 3}) == 1);                         // one edge, folded flat
  CHECK(pairs({a, b, c, {1, -1, 0}}, {1, 0, 3}) == 0);                        // one edge, side by side
  CHECK(pairs({a, b, c}, {0, 2, 1}) == 1);                                    // the same twice
  IndexedMesh two = tetrahedron();
  add_tetrahedron(two, {0.1F, 0.1F, 0.1F});
  CHECK(check_mesh(two).closed_manifold());
  CHECK(count_self_intersections(two) > 0);
}

}  // namespace
}  // namespace sonoloft::test
