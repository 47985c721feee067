#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "core/cells/cell_store.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// Some of its slices have a bounded view.
CellStore sound_store() {
  CellStore store({Eigen::Vector3d::Constant(-50), Eigen::Vector3d::Constant(50)}, 0.01);
  std::mt19937 rng(3);
  for (int i = 0; i < 8; ++i) {
    Section section = test::section_of_discs(test::random_frame(rng, 15), {{{0, 0}, 20, 1}});
    if (i % 3 == 2) test::bound_view(section);
    (void)store.insert(section, CellComplex::anywhere);
  }
  return store;
}

/// What validate() says of a sound store after `harm` was done to it.
std::string after(const std::function<void(CellStore&)>& harm) {
  CellStore store = sound_store();
  harm(store);
  return validate(store);
}

std::string after_to_cell_4(const std::function<void(Polyhedron&)>& harm) {
  return after([&](CellStore& store) { harm(store.cells[4].shape); });
}

/// Closed, and touches the first nowhere.
void append_copy(Polyhedron& p) {
  const Polyhedron copy = p;
  for (PolyFace face : copy.faces) {
    face.first += static_cast<std::uint32_t>(copy.loops.size());
    p.faces.push_back(face);
  }
  for (const std::uint32_t v : copy.loops) p.loops.push_back(v + static_cast<std::uint32_t>(copy.vertices.size()));
  p.vertices.insert(p.vertices.end(), copy.vertices.begin(), copy.vertices.end());
}

/// Two faces of different cells on one side of one plane take one wall.
void share_a_side(CellStore& store) {
  for (PolyFace& a : store.cells[1].shape.faces)
    for (std::size_t c = 2; c < store.cells.size(); ++c)
      for (const PolyFace& b : store.cells[c].shape.faces) {
        if (a.plane != b.plane || a.above != b.above) continue;
        store.release_wall(a.polygon);
        a.polygon = b.polygon;
        ++store.walls[a.polygon].users;
        return;
      }
}

}  // namespace

TEST_CASE("validate: a sound complex passes") {
  CHECK(sound_store().cells.size() > 20);
  CHECK(validate(sound_store()) == "");
}

TEST_CASE("validate: a cell that is no polyhedron is seen") {
  CHECK(after_to_cell_4([](Polyhedron& p) { p.faces.pop_back(); }) == "cell 4: an edge with one face only");
  CHECK(after_to_cell_4([](Polyhedron& p) { p.faces[1].count = 2; }) == "cell 4: a face with fewer than 3 vertices");
  CHECK(after_to_cell_4([](Polyhedron& p) { p.loops[p.faces[0].first] = p.loops[p.faces[0].first + 1]; }) ==
        "cell 4: an edge from a vertex to itself");
  CHECK(after_to_cell_4([](Polyhedron& p) {
          std::reverse(&p.loops[p.faces[0].first], &p.loops[p.faces[0].first] + p.faces[0].count);
        }) == "cell 4: an edge used twice in one direction");
  CHECK(after_to_cell_4([](Polyhedron& p) { p.vertices[0].position += Eigen::Vector3d::Constant(1e-10); }) ==
        "cell 4: a vertex off the plane of its face");
  CHECK(after_to_cell_4([](Polyhedron& p) { p.faces[0].above ^= true; }) == "cell 4: a vertex beyond a face");
  CHECK(after_to_cell_4([](Polyhedron& p) { p.vertices.push_back(p.vertices[0]); }) ==
        "cell 4: Euler's formula does not hold");
  CHECK(after_to_cell_4(append_copy) == "cell 4: Euler's formula does not hold");
}

TEST_CASE("validate: a wall with the wrong cells at it is seen") {
  CHECK(after([](CellStore& s) { ++s.walls[7].users; }) == "wall 7: wrong count of users");
  CHECK(after(share_a_side).find("two cells on one side") != std::string::npos);
  // One face lies in a plane of its own, so that nothing faces it any more.
  CHECK(after([](CellStore& s) {
          PolyFace& face = s.cells[4].shape.faces.back();
          s.planes.push_back(s.planes[face.plane]);
          face.plane = static_cast<std::uint32_t>(s.planes.size() - 1);
        }).find("walls with one side only") != std::string::npos);
}

TEST_CASE("validate: a volume that is 2e-9 of the box off is seen") {
  CHECK(after([](CellStore& s) { s.box.max().x() += 2e-7; }) == "volumes do not add up to the box");
}

TEST_CASE("validate: a tree that leads elsewhere is seen") {
  CHECK(after([](CellStore& s) {
          std::swap(s.nodes.back().child[0], s.nodes.back().child[1]);
        }).find("the tree does not lead to its centre") != std::string::npos);
}
