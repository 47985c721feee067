#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "core/mesh/surface_extractor.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/synthetic_lattice.h"

namespace sonoloft::test {
namespace {

struct Extracted {
  IndexedMesh mesh;
  SurfaceExtractor::Counters counters;
};

Extracted extract(const SyntheticLattice& lattice, int threads = 1) {
  SurfaceExtractor extractor;
  extractor.update(lattice, lattice.bricks(), threads);
  return {extractor.snapshot().indexed(), extractor.counters()};
}

/// @return the angle in degrees that 5 % of the triangles have a smaller one than
double check_sound(const std::string& name, const Extracted& extracted) {
  const MeshReport report = check_mesh(extracted.mesh);
  const auto angles = smallest_angles_deg(extracted.mesh);
  const std::size_t intersections = count_self_intersections(extracted.mesh);
  REQUIRE(!angles.empty());
  MESSAGE(name, ": ", extracted.counters.leaves, " leaves, ", extracted.counters.complex_cells, " complex, ",
          extracted.counters.fans, " fans, ", extracted.mesh.triangles.size(), " triangles, smallest angle 0 % ",
          angles.front(), " 5 % ", angles[angles.size() / 20], " median ", angles[angles.size() / 2], " deg; ",
          intersections, " intersections; ", report.text());
  CHECK(report.closed_manifold());
  CHECK(intersections == 0);
  CHECK(extracted.counters.collapsed_triangles == 0);
  return angles[angles.size() / 20];
}

/// Half spaces and layers whose sides follow a tilted plane; `thickness` in steps.
ShareField sheet_field(Eigen::Vector3d normal, double thickness) {
  return [normal = normal.normalized(), thickness](Eigen::Vector3i p, std::span<float> shares) {
    const Eigen::Vector3d from_middle = p.cast<double>() - Eigen::Vector3d::Constant(16);
    const double sheet = thickness / 2 - std::abs(normal.dot(from_middle));
    const double disc = 11 - from_middle.norm();
    shares[1] = static_cast<float>(std::min(sheet, disc));
  };
}

TEST_CASE("mesh: a sphere is one closed surface with the sphere's volume, and its normals point out") {
  const double radius = 12.3;
  const SyntheticLattice lattice(32, 2, sphere_field({16.2, 15.7, 16.1}, radius));
  const Extracted sphere = extract(lattice);
  CHECK(check_sound("sphere", sphere) > 30);
  const LabelReport label = check_mesh(sphere.mesh).labels.at(1);
  CHECK(label.components == 1);
  CHECK(label.genus() == 0);
  CHECK(label.volume_mm3 == doctest::Approx(4.0 / 3 * M_PI * radius * radius * radius).epsilon(0.01));
  CHECK(sphere.counters.complex_cells == 0);
}

TEST_CASE("mesh: four overlapping spheres share their interfaces") {
  const SyntheticLattice lattice(48, 5,
                                 spheres_field({{{18.3, 19.1, 20.2}, 11.4},
                                                {{29.7, 20.3, 21.9}, 10.2},
                                                {{23.1, 30.6, 22.4}, 11.9},
                                                {{24.2, 23.9, 31.7}, 10.7}}));
  const Extracted spheres = extract(lattice);
  check_sound("four spheres", spheres);
  const MeshReport report = check_mesh(spheres.mesh);
  REQUIRE(report.labels.size() == 5);
  double sum = 0;
  for (const auto& [label, r] : report.labels) {
    CHECK(r.components == 1);
    CHECK(r.genus() == 0);
    sum += r.volume_mm3;
  }
  CHECK(sum == doctest::Approx(0).epsilon(1e-3));  // space is filled without gap or overlap
}

TEST_CASE(
    "mesh: noise of five labels, where a third of the cells are not simple, is closed, manifold, embedded and of round "
    "triangles") {
  for (const std::uint64_t seed : {1u, 2u}) {
    const SyntheticLattice lattice(24, 5, noise_field(seed, 1));
    const Extracted noise = extract(lattice);
    CHECK(check_sound("noise " + std::to_string(seed), noise) >= 25);
    CHECK(3 * noise.counters.complex_cells > noise.counters.leaves);
  }
}

TEST_CASE(
    "mesh: noise of 2, 3, 5 and 9 labels, where half of the cells are not simple, is closed, manifold, embedded and of "
    "round triangles") {
  for (const int labels : {2, 3, 5, 9}) {
    const SyntheticLattice lattice(24, labels, noise_field(static_cast<std::uint64_t>(labels), 0));
    const Extracted noise = extract(lattice);
    CHECK(check_sound("raw noise, labels " + std::to_string(labels), noise) >= 25);
    CHECK(2 * noise.counters.complex_cells > noise.counters.leaves);
  }
}

TEST_CASE("mesh: shares that tie everywhere are closed, manifold and embedded") {
  for (const int labels : {2, 4}) {
    const auto coarse = [noise = noise_field(17, 0)](Eigen::Vector3i p, std::span<float> shares) {
      noise(p, shares);
      for (float& share : shares) share = std::floor(3 * share);
    };
    check_sound("ties, labels " + std::to_string(labels), extract(SyntheticLattice(14, labels, coarse)));
  }
}

TEST_CASE("mesh: smooth folds and triple lines of four labels are closed, manifold and embedded") {
  for (const std::uint64_t seed : {1u, 2u}) {
    const Extracted waves = extract(SyntheticLattice(48, 4, waves_field(seed)));
    check_sound("waves " + std::to_string(seed), waves);
    CHECK(waves.counters.complex_cells > 0);
    CHECK(20 * waves.counters.complex_cells < waves.counters.leaves);
  }
}

TEST_CASE("mesh: sheets thinner than a cell stay closed whatever is lost of them") {
  for (const double thickness : {0.4, 0.9, 1.3, 2.0}) {
    const SyntheticLattice lattice(32, 2, sheet_field({0.3, 0.5, 1}, thickness));
    check_sound("sheet " + std::to_string(thickness), extract(lattice));
  }
}

TEST_CASE("mesh: all 3^8 ways to label one cell with three labels are closed, manifold and embedded") {
  // Isolated 2x2x2 groups of points, 3 outside points apart.
  std::size_t complex_cells = 0;
  for (int batch = 0; batch < 8; ++batch) {
    const int side = 10;  // groups along an axis
    const auto field = [&](Eigen::Vector3i p, std::span<float> shares) {
      const Eigen::Vector3i group = p / 5, in_group = p - 5 * group - Eigen::Vector3i::Constant(2);
      shares[0] = 0.5F;
      int code = batch * side * side * side + group.x() + side * (group.y() + side * group.z());
      if (code >= 6561 || in_group.minCoeff() < 0 || in_group.maxCoeff() > 1) return;
      for (int c = in_group.x() + 2 * in_group.y() + 4 * in_group.z(); c > 0; --c) code /= 3;
      if (code % 3 > 0) shares[static_cast<std::size_t>(code % 3)] = 0.6F + 0.1F * static_cast<float>(code % 7);
    };
    const SyntheticLattice lattice(5 * side, 3, field);
    const Extracted cells = extract(lattice);
    complex_cells += cells.counters.complex_cells;
    const MeshReport report = check_mesh(cells.mesh);
    INFO(report.text());
    CHECK(report.closed_manifold());
    CHECK(count_self_intersections(cells.mesh) == 0);
  }
  MESSAGE("complex cells ", complex_cells);
  CHECK(complex_cells > 6561 / 3);
}

TEST_CASE(
    "mesh: whether two points of a label across a face or a cell touch is as the samples say, wherever they are") {
  const Eigen::Vector3i first(4, 5, 4);
  for (const Eigen::Vector3i& step : {Eigen::Vector3i(1, 1, 0), Eigen::Vector3i(1, -1, 0), Eigen::Vector3i(0, 1, 1),
                                      Eigen::Vector3i(0, 1, -1), Eigen::Vector3i(1, 0, 1), Eigen::Vector3i(1, 0, -1),
                                      Eigen::Vector3i(1, 1, 1), Eigen::Vector3i(1, -1, 1), Eigen::Vector3i(-1, 1, 1)})
    for (const int moved : {0, 1})
      for (const bool strong : {false, true}) {
        const Eigen::Vector3i a = first + Eigen::Vector3i(moved, 0, 0), b = a + step;
        const auto field = [&](const Eigen::Vector3i& p, std::span<float> shares) {
          const bool inside = p == a || p == b;
          shares[inside ? 1 : 0] = inside == strong ? 1.0F : 0.3F;
        };
        const MeshReport report = check_mesh(extract(SyntheticLattice(10, 2, field)).mesh);
        CAPTURE(step.transpose());
        CAPTURE(strong);
        CHECK(report.closed_manifold());
        CHECK(report.labels.at(1).components == (strong ? 1 : 2));
      }
}

TEST_CASE("mesh: faces with one label on a diagonal and others on the other are closed for every label") {
  // ABAB and ABAC in the face between two cells.
  for (const int other : {1, 2}) {
    const auto field = [&](Eigen::Vector3i p, std::span<float> shares) {
      shares[0] = 0.5F;
      if (p == Eigen::Vector3i(4, 4, 4)) shares[1] = 1;
      if (p == Eigen::Vector3i(5, 5, 4)) shares[static_cast<std::size_t>(other)] = 1;
    };
    const SyntheticLattice lattice(9, 3, field);
    const Extracted faces = extract(lattice);
    check_sound("diagonal", faces);
    CHECK(faces.counters.complex_cells > 0);
    const auto report = check_mesh(faces.mesh);
    CHECK(report.labels.at(1).closed_manifold());
  }
}

}  // namespace
}  // namespace sonoloft::test
