#include "core/field/packing/packed_cells.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/field/field_evaluator.h"
#include "tests/support/field/field_cells.h"
#include "tests/support/field/long_contours.h"

using namespace sonoloft;
using test::FieldCell;

namespace {

/// A cube of 2 mm around `at`, every wall of one label: +x, -x, +y, -y, +z, -z.
FieldCell cube(const std::array<Label, 6>& labels, const Eigen::Vector3d& at = Eigen::Vector3d::Zero()) {
  test::Random random(1);
  std::vector<test::Wall> walls;
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Vector3d outward = (i % 2 == 0 ? 1 : -1) * Eigen::Vector3d::Unit(static_cast<int>(i / 2));
    FacePolygon polygon;
    test::add_loop(polygon, {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, labels[i], kBeyondFace);
    walls.push_back(test::random_wall(random, outward, 1.0, std::move(polygon)));
  }
  return FieldCell(walls, at);
}

std::vector<Label> slots(const PackedCells& cells, std::uint32_t cell) {
  return {cells.labels(cell).begin(), cells.labels(cell).end()};
}

std::vector<Label> slots(const std::array<Label, 6>& labels) {
  const FieldCell cell = cube(labels);
  PackedCells cells;
  cells.add(cell.faces(), cell.centre());
  return slots(cells, 0);
}

}  // namespace

TEST_CASE("packed cells: a cell of one known label is constant") {
  CHECK(slots({7, 7, 7, 7, 7, 7}) == std::vector<Label>{7});
  CHECK(slots({0, 0, 0, 0, 0, 0}) == std::vector<Label>{0});
}

TEST_CASE("packed cells: slots are the labels of the walls ascending, unknown last") {
  CHECK(slots({kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown}) == std::vector<Label>{kUnknown});
  CHECK(slots({7, 3, 7, 7, 7, 3}) == std::vector<Label>{3, 7});
  CHECK(slots({7, 7, 7, kUnknown, 7, 7}) == std::vector<Label>{7, kUnknown});
  CHECK(slots({9, 0, 2, kUnknown, 2, 5}) == std::vector<Label>{0, 2, 5, 9, kUnknown});
}

TEST_CASE("packed cells: faces without edges are a constant cell of which nothing is known") {
  FieldCell cell = cube({1, 2, 1, 1, 1, 1});
  const FacePolygon empty;
  std::vector<CellFace> faces = cell.faces();
  for (CellFace& face : faces) face.polygon = &empty;
  PackedCells cells;
  cells.add(faces, cell.centre());
  CHECK(slots(cells, 0) == std::vector<Label>{kUnknown});
  CHECK(cells.constant(0));
  CHECK(cells.edge_count(0) == 0);
}

TEST_CASE("packed cells: every edge of a cell that is not constant is packed once, in units of the cell's size") {
  test::Random random(4);
  const std::array<Label, 4> labels = {0, 1, 2, kUnknown};
  PackedCells cells;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const FieldCell cell(test::random_walls(random, 9, labels, 8, 50.0));
    REQUIRE(cells.add(cell.faces(), cell.centre()) == i);
    std::size_t edges = 0;
    for (const test::Wall& wall : cell.walls()) edges += wall.polygon.size();
    CHECK(cells.edge_count(i) == edges);
    const kernels::PackedCell& packed = cells.cells()[i];
    for (const auto& face : cells.faces().subspan(packed.first_face, packed.face_count)) {
      CHECK(face.height > 0);
      CHECK(face.height <= 0.5f);
      CHECK(face.bent_count == 0);
      for (const auto& run : cells.runs().subspan(face.first_run, face.rigid_count)) {
        CHECK(run.left < run.right);
        for (const auto& edge : cells.edges().subspan(run.first, run.count)) CHECK(std::abs(edge.x) <= 0.5f);
      }
    }
  }
  CHECK(cells.size() == 20);
  cells.clear();
  CHECK(cells.size() == 0);
}

TEST_CASE("field: what is unknown has its share like every label") {
  // Seen from the middle, the six walls of a cube weigh the same.
  const FieldCell cell = cube({7, 7, 3, kUnknown, 0, kUnknown}, {1000, -2000, 500});
  FieldBatch batch;
  const Eigen::Vector3d middle = cell.centre();
  batch.add_points(batch.cells.add(cell.faces(), cell.centre()), {&middle, 1});
  REQUIRE(make_cpu_evaluator(1)->evaluate(batch));
  REQUIRE(slots(batch.cells, 0) == std::vector<Label>{0, 3, 7, kUnknown});
  CHECK(batch.row(0, 0)[0] == doctest::Approx(1.0 / 6).epsilon(1e-6));
  CHECK(batch.row(0, 1)[0] == doctest::Approx(1.0 / 6).epsilon(1e-6));
  CHECK(batch.row(0, 2)[0] == doctest::Approx(2.0 / 6).epsilon(1e-6));
  CHECK(batch.row(0, 3)[0] == doctest::Approx(2.0 / 6).epsilon(1e-6));
}

TEST_CASE("field: unknown parts of faces that are apart have slots of their own, in the order of the faces") {
  test::Random random(9);
  const std::array<Label, 4> labels = {0, 1, 2, kUnknown};
  const FieldCell cell(test::random_walls(random, 9, labels, 8, 50.0));
  const std::vector<CellFace> faces = cell.faces();
  std::vector<std::uint32_t> unknown;
  for (std::uint32_t i = 0; i < faces.size(); ++i)
    if (has_unknown(*faces[i].polygon)) unknown.push_back(i);
  REQUIRE(unknown.size() >= 3);
  const std::vector<std::uint32_t> apart(unknown.begin() + 1, unknown.end());
  FieldBatch together, some;
  const std::vector<Eigen::Vector3d> points(1, cell.centre());
  together.add_points(together.cells.add(faces, cell.centre()), points);
  some.add_points(some.cells.add(faces, cell.centre(), apart), points);
  const auto evaluator = make_cpu_evaluator(1);
  REQUIRE(evaluator->evaluate(together));
  REQUIRE(evaluator->evaluate(some));
  const std::size_t known = together.cells.labels(0).size() - 1;
  const std::span<const Label> slots = some.cells.labels(0);
  REQUIRE(slots.size() == known + 1 + apart.size());
  float sum = 0;
  for (std::uint32_t slot = 0; slot < slots.size(); ++slot) {
    const float share = some.row(0, slot)[0];
    CHECK((slots[slot] == kUnknown) == (slot >= known));
    CHECK(share > 0);
    if (slot >= known)
      sum += share;
    else
      CHECK(share == doctest::Approx(together.row(0, slot)[0]).epsilon(1e-5));
  }
  CHECK(sum == doctest::Approx(together.row(0, static_cast<std::uint32_t>(known))[0]).epsilon(1e-5));

  // Of one of them alone: all else is known in another cell.
  FieldBatch last;
  std::vector<FacePolygon> polygons;
  for (const CellFace& face : faces) polygons.push_back(*face.polygon);
  std::vector<CellFace> relabelled = faces;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i != apart.back())
      for (FaceEdge& e : polygons[i])
        for (Label* label : {&e.left, &e.right})
          if (*label == kUnknown) *label = 9;
    relabelled[i].polygon = &polygons[i];
  }
  last.add_points(last.cells.add(relabelled, cell.centre()), points);
  REQUIRE(evaluator->evaluate(last));
  const auto end = static_cast<std::uint32_t>(last.cells.labels(0).size() - 1);
  CHECK(some.row(0, static_cast<std::uint32_t>(slots.size() - 1))[0] ==
        doctest::Approx(last.row(0, end)[0]).epsilon(1e-5));
}

TEST_CASE("field: a batch can be evaluated again with more points, other points, and none") {
  const FieldCell cell = cube({7, 7, 7, 7, 0, 0});
  FieldBatch batch;
  const std::uint32_t index = batch.cells.add(cell.faces(), cell.centre());
  const auto evaluator = make_cpu_evaluator(1);
  REQUIRE(evaluator->evaluate(batch));
  CHECK(batch.share.empty());
  const std::vector<Eigen::Vector3d> points(33, Eigen::Vector3d(0, 0, 0));
  CHECK(batch.add_points(index, {points.data(), 1}) == 0);
  CHECK(batch.add_points(index, points) == 1);
  REQUIRE(evaluator->evaluate(batch));
  CHECK(batch.row(1, 1).size() == 33);
  for (const float share : batch.row(1, 1)) CHECK(share == doctest::Approx(4.0 / 6).epsilon(1e-6));
  batch.clear_points();
  CHECK(batch.add_points(index, {points.data(), 1}) == 0);
  REQUIRE(evaluator->evaluate(batch));
  CHECK(batch.row(0, 0)[0] == doctest::Approx(2.0 / 6).epsilon(1e-6));
}

TEST_CASE("packed cells: the edges of a contour are one chain, in whatever order they come") {
  const FieldCell cell = test::wavy_cell(20);
  std::vector<FacePolygon> shuffled;
  for (const test::Wall& wall : cell.walls()) shuffled.push_back(wall.polygon);
  test::Random random(3);
  for (FacePolygon& polygon : shuffled) std::shuffle(polygon.begin(), polygon.end(), random);
  std::vector<CellFace> faces = cell.faces();
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i].polygon = &shuffled[i];
  PackedCells cells;
  cells.add(faces, cell.centre(), {}, cell.bends());
  std::size_t contours = 0;
  for (const kernels::PackedFace& face : cells.faces()) {
    if (face.bent_count == 0) continue;
    ++contours;
    CHECK(face.bent_count == 1);
    CHECK(cells.runs()[face.first_run + face.rigid_count].count == 20);
  }
  CHECK(contours == 2);
}

TEST_CASE("packed cells: cells packed in parts and joined are those packed one after the other, to the last bit") {
  test::Random random(11);
  const std::array<Label, 4> labels = {0, 1, 2, kUnknown};
  PackedCells whole, first, rest;
  for (int i = 0; i < 5; ++i)
    for (const FieldCell& cell : {FieldCell(test::random_walls(random, 9, labels, 8, 50.0)), test::wavy_cell(100 + i),
                                  cube({3, 3, 3, 3, 3, 3})}) {
      whole.add(cell.faces(), cell.centre(), {}, cell.bends());
      (i < 2 ? first : rest).add(cell.faces(), cell.centre(), {}, cell.bends());
    }
  PackedCells joined;
  for (const PackedCells* part : {&first, &rest}) joined.append(*part);
  CHECK(joined.size() == 15);
  CHECK(joined.stretches().size() > first.stretches().size());
  const auto same = [](const auto& a, const auto& b) { return std::ranges::equal(std::as_bytes(a), std::as_bytes(b)); };
  CHECK(same(joined.cells(), whole.cells()));
  CHECK(same(joined.faces(), whole.faces()));
  CHECK(same(joined.runs(), whole.runs()));
  CHECK(same(joined.edges(), whole.edges()));
  CHECK(same(joined.vertices(), whole.vertices()));
  CHECK(same(joined.stretches(), whole.stretches()));
  for (std::uint32_t i = 0; i < joined.size(); ++i) {
    CHECK(slots(joined, i) == slots(whole, i));
    CHECK(joined.centre_mm(i) == whole.centre_mm(i));
  }
}
