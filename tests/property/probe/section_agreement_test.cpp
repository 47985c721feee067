#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "device_sim/probe/phantoms/mesh_phantom.h"
#include "device_sim/probe/phantoms/solid_phantom.h"
#include "device_sim/probe/phantoms/volume_phantom.h"
#include "tests/support/mesh/solid_meshes.h"
#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

void check_agreement(const Phantom& phantom, const std::string& name, double clear_mm, int planes) {
  Random random(11);
  test::Agreement all;
  for (int i = 0; i < planes; ++i) {
    const Eigen::Isometry3d cut = test::random_plane(phantom.bounds(), random);
    CHECK(test::well_formed(phantom.section(cut)));
    const test::Agreement here = test::agreement(phantom, cut, clear_mm, 200, random);
    all.points += here.points;
    all.agreed += here.agreed;
  }
  MESSAGE(name << ": " << all.agreed << " of " << all.points << " points agree");
  CHECK(all.points > planes * 100);
  CHECK(all.agreed >= 0.999 * all.points);
}

}  // namespace

TEST_CASE("sections: the smallest loop around a point tells what a body of solids has there") {
  const SolidPhantom phantom = organs_phantom();
  check_agreement(phantom, "organs", phantom.spacing_mm(), 100);
}

TEST_CASE("sections: of a window, they tell what a body has there") {
  const SolidPhantom phantom = organs_phantom();
  Random random(12);
  test::Agreement all;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Isometry3d cut = test::random_plane(phantom.bounds(), random);
    const Eigen::Vector2d corner(40 * random.normal(), 40 * random.normal());
    const Eigen::AlignedBox2d window(corner, corner + Eigen::Vector2d(70, 60));
    CHECK(test::well_formed(phantom.section_in(window, cut)));
    const test::Agreement here = test::agreement(phantom, cut, phantom.spacing_mm(), 100, random, window);
    all.points += here.points;
    all.agreed += here.agreed;
  }
  MESSAGE("windows: " << all.agreed << " of " << all.points << " points agree");
  CHECK(all.points > 3000);
  CHECK(all.agreed >= 0.999 * all.points);
}

TEST_CASE("sections: the smallest loop around a point tells what a mesh has there") {
  sonoloft::IndexedMesh inner = test::sphere_mesh({2, 1, 0}, 12, 3);
  for (auto& t : inner.triangles) std::swap(t[1], t[2]);
  const sonoloft::IndexedMesh mesh = test::together(test::together(test::sphere_mesh({0, 0, 0}, 20, 3), inner),
                                                    test::box_mesh({15, 30, -9}, {40, 50, 11}));
  std::vector<Eigen::Vector3d> positions;
  for (const Eigen::Vector3f& p : mesh.positions) positions.push_back(p.cast<double>());
  const auto phantom = MeshPhantom::make(positions, mesh.triangles, 5);
  REQUIRE(phantom.value);
  check_agreement(*phantom.value, "mesh", 1e-6, 100);
}

TEST_CASE("sections: the smallest loop around a point tells what a volume has there, junctions and noise included") {
  // Four labels in wavy columns, with specks: many junctions, four labels to a point among them.
  const Eigen::Vector3i dims(60, 50, 30);
  std::vector<Label> labels;
  Random random(4);
  for (int z = 0; z < dims.z(); ++z) {
    for (int y = 0; y < dims.y(); ++y) {
      for (int x = 0; x < dims.x(); ++x) {
        const double u = x + 3 * std::sin(0.2 * y), v = y + 3 * std::sin(0.3 * z + 0.1 * x);
        const int column = (u > 30) + 2 * (v > 25);
        labels.push_back(static_cast<Label>(random.uniform() < 0.01 ? 0 : column));
      }
    }
  }
  const auto phantom = VolumePhantom::make(dims, {1, 1.2, 2}, {0, 0, 0}, labels);
  REQUIRE(phantom.value);
  check_agreement(*phantom.value, "volume", phantom.value->grid_mm(), 100);
}
