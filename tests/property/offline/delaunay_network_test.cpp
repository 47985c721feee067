#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/mesh/surface_extractor.h"
#include "core/offline/delaunay_mesher.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/synthetic_lattice.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

MeshSnapshot live_mesh(const SyntheticLattice& lattice) {
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), 1);
  return extractor.snapshot();
}

IndexedMesh refined(const SyntheticLattice& lattice) {
  auto mesh = delaunay_mesh(lattice, live_mesh(lattice), DelaunayCriteria::like_live(lattice.spacing_mm()));
  if (!mesh) FAIL(mesh.error().message);
  return std::move(mesh->mesh);
}

/// With shares that are positive, as those of slices are: a label that is not in a brick has share 0 there.
ShareField positive(const ShareField& field) {
  return [field](Eigen::Vector3i p, std::span<float> shares) {
    field(p, shares);
    for (float& share : shares) share = std::exp(share);
  };
}

double ball_mm3(double radius) {
  return 4.0 / 3 * std::numbers::pi * radius * radius * radius;
}

/// Closed for every label of the live mesh and embedded.
void check_closed(const std::string& name, const SyntheticLattice& lattice, const IndexedMesh& mesh) {
  const IndexedMesh live = live_mesh(lattice).indexed();
  const MeshReport report = check_mesh(mesh);
  const auto angles = smallest_angles_deg(mesh);
  const std::size_t intersections = count_self_intersections(mesh);
  std::size_t edges = 0, vertices = 0;
  for (const auto& [label, of_label] : report.labels) {
    CHECK(of_label.boundary_edges == 0);
    edges += of_label.non_manifold_edges;
    vertices += of_label.non_manifold_vertices;
  }
  const auto below_30 = std::ranges::lower_bound(angles, 29.9) - angles.begin();
  MESSAGE(name, ": ", mesh.triangles.size(), " triangles, live ", live.triangles.size(), "; smallest angle 0 % ",
          angles.front(), " 5 % ", angles[angles.size() / 20], " median ", angles[angles.size() / 2], " deg, ",
          below_30, " below 30; over all labels ", edges, " non-manifold edges, ", vertices, " vertices; ",
          intersections, " intersections");
  CHECK(intersections == 0);
  CHECK(report.degenerate_triangles == 0);
  const auto one_in_thousand = static_cast<long>(mesh.triangles.size() / 1000);
  CHECK(below_30 <= one_in_thousand);
  CHECK(static_cast<long>(edges + vertices) <= one_in_thousand);
  for (const auto& [label, of_live] : check_mesh(live).labels) CHECK(report.labels.contains(label));
}

/// And manifold for every label.
void check_sound(const std::string& name, const SyntheticLattice& lattice, const IndexedMesh& mesh) {
  check_closed(name, lattice, mesh);
  const MeshReport report = check_mesh(mesh);
  CHECK_MESSAGE(report.closed_manifold(), report.text());
}

}  // namespace

TEST_CASE("offline: a ball is one closed surface with the ball's volume, about as fine as the live one") {
  const double radius = 12.3;
  const SyntheticLattice lattice(32, 2, sphere_field({16.2, 15.7, 16.1}, radius));
  const IndexedMesh mesh = refined(lattice);
  check_sound("ball", lattice, mesh);
  const LabelReport ball = check_mesh(mesh).labels.at(1);
  CHECK(ball.components == 1);
  CHECK(ball.genus() == 0);
  CHECK(ball.volume_mm3 == doctest::Approx(ball_mm3(radius)).epsilon(0.01));
  const double live_triangles = static_cast<double>(live_mesh(lattice).indexed().triangles.size());
  CHECK(static_cast<double>(mesh.triangles.size()) == doctest::Approx(live_triangles).epsilon(0.1));
}

TEST_CASE("offline: a ball in a ball and two balls apart, one of a single sample, are all found") {
  const SyntheticLattice nested(32, 3, [](Eigen::Vector3i p, std::span<float> shares) {
    const double r = (p.cast<double>() - Eigen::Vector3d(16.2, 15.7, 16.1)).norm();
    shares[0] = static_cast<float>(r - 12);
    shares[1] = static_cast<float>(r < 9 ? r - 6 : 12 - r);
    shares[2] = static_cast<float>(6 - r);
  });
  const IndexedMesh mesh = refined(nested);
  check_sound("nested", nested, mesh);
  CHECK(check_mesh(mesh).labels.at(2).volume_mm3 == doctest::Approx(ball_mm3(6)).epsilon(0.03));
  CHECK(check_mesh(mesh).labels.at(1).volume_mm3 == doctest::Approx(ball_mm3(12) - ball_mm3(6)).epsilon(0.02));
  CHECK(check_mesh(mesh).labels.at(1).components == 2);

  const SyntheticLattice apart(32, 3, spheres_field({{{11, 11, 11}, 7.5}, {{24, 24, 24}, 0.6}}));
  const IndexedMesh balls = refined(apart);
  check_sound("apart", apart, balls);
  CHECK(check_mesh(balls).labels.at(1).components == 1);
  CHECK(check_mesh(balls).labels.at(2).components == 1);
}

TEST_CASE("offline: where three and four labels meet, the boundary of each is a closed 2-manifold") {
  const SyntheticLattice spheres(
      32, 5, spheres_field({{{12, 12, 13}, 8.3}, {{20, 12, 14}, 7.6}, {{16, 20, 13}, 7.9}, {{16, 15, 20}, 7.2}}));
  check_sound("four balls", spheres, refined(spheres));
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const SyntheticLattice waves(24, 4, positive(waves_field(seed)));
    check_closed("waves", waves, refined(waves));
  }
  const SyntheticLattice noise(16, 4, positive(noise_field(7, 1)));
  check_closed("noise", noise, refined(noise));
}

TEST_CASE("offline: the same samples give the same mesh") {
  const SyntheticLattice lattice(24, 4, positive(waves_field(5)));
  const IndexedMesh a = refined(lattice), b = refined(lattice);
  CHECK(a.positions == b.positions);
  CHECK(a.triangles == b.triangles);
  CHECK(a.label_front == b.label_front);
  CHECK(a.label_back == b.label_back);
}

TEST_CASE("offline: criteria that make no sense and a mesh without triangles are errors") {
  const SyntheticLattice lattice(16, 2, sphere_field({8, 8, 8}, 4));
  const MeshSnapshot live = live_mesh(lattice);
  const auto code = [&](const MeshSnapshot& mesh, DelaunayCriteria criteria) {
    const auto result = delaunay_mesh(lattice, mesh, criteria);
    REQUIRE(!result);
    return result.error().code;
  };
  CHECK(code(live, {31, 1, 1}) == ErrorCode::invalid_argument);
  CHECK(code(live, {30, 0, 1}) == ErrorCode::invalid_argument);
  CHECK(code(live, {30, 1, -1}) == ErrorCode::invalid_argument);
  CHECK(code({}, {30, 1, 1}) == ErrorCode::empty_input);
}
