#include "device_sim/probe/phantoms/mesh_phantom.h"

#include <doctest/doctest.h>

#include <limits>
#include <numbers>

#include "tests/support/mesh/solid_meshes.h"
#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

Made<MeshPhantom> make(const sonoloft::IndexedMesh& mesh, Label label = 1) {
  std::vector<Eigen::Vector3d> positions;
  for (const Eigen::Vector3f& p : mesh.positions) positions.push_back(p.cast<double>());
  return MeshPhantom::make(positions, mesh.triangles, label);
}

double area(const PhantomSection& section) {
  double sum = 0;
  for (const SectionLoop& loop : section.loops)
    sum += (loop.hole ? -1 : 1) * test::loop_area(test::points_of(section, loop));
  return sum;
}

}  // namespace

TEST_CASE("mesh: the section of a fine sphere has the area of its circle") {
  const auto mesh = make(test::sphere_mesh({10, 20, 30}, 50, 6));
  REQUIRE(mesh.value);
  const Eigen::Vector3d normal = Eigen::Vector3d(-1, 0.4, 2).normalized();
  for (const double d : {0.0, 17.0, -33.0, 45.0}) {
    const PhantomSection section =
        mesh.value->section(test::plane_at(Eigen::Vector3d(10, 20, 30) + d * normal, normal));
    REQUIRE(section.loops.size() == 1);
    CHECK(test::well_formed(section));
    CHECK(std::abs(area(section) / (std::numbers::pi * (2500 - d * d)) - 1) < 1e-3);
  }
}

TEST_CASE("mesh: the areas of a stack of sections add up to the volume") {
  const auto mesh =
      make(test::together(test::sphere_mesh({0, 0, 0}, 20, 3), test::box_mesh({15, 30, -9}, {40, 50, 11})));
  REQUIRE(mesh.value);
  const Eigen::Isometry3d frame = test::plane_at({0, 0, 0}, {1, 2, 3});
  constexpr int kPlanes = 2000;
  double volume = 0;
  for (int i = 0; i < kPlanes; ++i)
    volume += area(mesh.value->section(frame * Eigen::Translation3d(0, 0, -100 + 200 * (i + 0.5) / kPlanes)));
  volume *= 200.0 / kPlanes;
  MESSAGE("stack " << volume << " mm3, mesh " << mesh.value->volume_mm3() << " mm3");
  CHECK(std::abs(volume / mesh.value->volume_mm3() - 1) < 1e-3);
}

TEST_CASE("mesh: a shell has a hole") {
  sonoloft::IndexedMesh inner = test::sphere_mesh({0, 0, 0}, 12, 4);
  for (auto& t : inner.triangles) std::swap(t[1], t[2]);
  const auto mesh = make(test::together(test::sphere_mesh({0, 0, 0}, 30, 4), inner), 3);
  REQUIRE(mesh.value);
  const PhantomSection section = mesh.value->section(test::plane_at({0, 0, 1}, {0, 0, 1}));
  REQUIRE(section.loops.size() == 2);
  CHECK(section.loops[0].hole != section.loops[1].hole);
  CHECK(area(section) == doctest::Approx(std::numbers::pi * (900 - 144)).epsilon(5e-3));
  CHECK(mesh.value->label_at({0, 0, 0}) == kOutside);
  CHECK(mesh.value->label_at({20, 0, 0}) == 3);
  CHECK(mesh.value->label_at({31, 0, 0}) == kOutside);
}

TEST_CASE("mesh: a plane through faces, edges and vertices of a cube gives closed loops of the right area") {
  const auto cube = make(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
  REQUIRE(cube.value);
  struct Case {
    const char* name;
    Eigen::Vector3d point, normal;
    double area, other_side;  // what lies on the plane counts as above: of a face, one of the two directions sees it
  };
  const double r2 = std::sqrt(2.0);
  const Case cases[] = {
      {"middle", {0, 0, 0}, {0, 0, 1}, 4, 4},
      {"top face", {0, 0, 1}, {0, 0, 1}, 4, 0},
      {"bottom face", {0, 0, -1}, {0, 0, 1}, 0, 4},
      {"side face", {1, 0, 0}, {1, 0, 0}, 4, 0},
      {"two opposite edges", {0, 0, 0}, {1, 1, 0}, 4 * r2, 4 * r2},
      {"one edge, outside", {1, 1, 0}, {1, 1, 0}, 0, 0},
      {"one vertex, outside", {1, 1, 1}, {1, 1, 1}, 0, 0},
      {"three vertices", {1, 1, -1}, {1, 1, 1}, 2 * std::sqrt(3.0), 2 * std::sqrt(3.0)},
  };
  for (const Case& c : cases) {
    INFO(c.name);
    const PhantomSection up = cube.value->section(test::plane_at(c.point, c.normal));
    const PhantomSection down = cube.value->section(test::plane_at(c.point, -c.normal));
    CHECK(test::well_formed(up));
    CHECK(test::well_formed(down));
    CHECK(area(up) == doctest::Approx(c.area).epsilon(1e-9));
    CHECK(area(down) == doctest::Approx(c.other_side).epsilon(1e-9));
  }
}

TEST_CASE("mesh: input that is no closed surface is refused and says why") {
  const sonoloft::IndexedMesh cube = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  const auto refused = [](const sonoloft::IndexedMesh& mesh, Label label, const char* word) {
    const auto made = make(mesh, label);
    INFO(made.error);
    CHECK(!made.value);
    CHECK(made.error.find(word) != std::string::npos);
  };
  sonoloft::IndexedMesh bad = cube;
  bad.triangles.pop_back();
  refused(bad, 1, "edge");
  bad = cube;
  std::swap(bad.triangles[3][0], bad.triangles[3][1]);
  refused(bad, 1, "edge");
  bad = cube;
  bad.triangles[5][2] = 99;
  refused(bad, 1, "vertex 99");
  bad = cube;
  bad.positions[0].x() = std::numeric_limits<float>::quiet_NaN();
  refused(bad, 1, "finite");
  bad = cube;
  for (Eigen::Vector3f& p : bad.positions) p.z() = 0;
  refused(bad, 1, "volume");
  refused(sonoloft::IndexedMesh{}, 1, "no triangles");
  refused(cube, 0, "label");
  refused(cube, 0xFFFF, "label");
}

TEST_CASE("mesh: a mesh turned inside out is turned back") {
  sonoloft::IndexedMesh cube = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  for (auto& t : cube.triangles) std::swap(t[1], t[2]);
  const auto made = make(cube);
  REQUIRE(made.value);
  CHECK(made.value->volume_mm3() == doctest::Approx(8));
  const PhantomSection section = made.value->section(test::plane_at({0, 0, 0.3}, {0, 0, 1}));
  REQUIRE(section.loops.size() == 1);
  CHECK(!section.loops[0].hole);
}
