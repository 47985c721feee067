#include "core/cells/cell_complex.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <set>

#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

const Eigen::AlignedBox3d kBox(Eigen::Vector3d(-50, -50, -50), Eigen::Vector3d(50, 50, 50));

std::vector<CellFace> faces_of(const CellComplex& complex, CellId cell) {
  std::vector<CellFace> faces;
  complex.faces(cell, faces);
  return faces;
}

}  // namespace

TEST_CASE("cells: an uncut box is one valid cell with six outside walls") {
  const CellComplex complex(kBox, 0.01);
  CHECK(complex.cell_count() == 1);
  CHECK(complex.validate() == "");
  CHECK(complex.volume(CellId{0}) == doctest::Approx(1e6));
  for (const CellFace& face : faces_of(complex, CellId{0})) {
    CHECK(face.label == kOutside);
    CHECK(face.above);
    CHECK(area(*face.polygon) == doctest::Approx(1e4));
  }
}

TEST_CASE("cells: a plane outside the box changes nothing") {
  CellComplex complex(kBox, 0.01);
  const auto delta = complex.insert(test::section_of_discs(test::frame_at({0, 0, 60}, {0, 0, 1}), {{{0, 0}, 10, 1}}));
  REQUIRE(!delta);
  CHECK(delta.error().code == ErrorCode::outside_box);
  CHECK(complex.cell_count() == 1);
  CHECK(complex.validate() == "");
}

TEST_CASE("cells: the same plane a second time changes nothing") {
  CellComplex complex(kBox, 0.01);
  const Section section = test::section_of_discs(test::frame_at({1, 2, 3}, {0.3, -0.5, 0.8}), {{{0, 0}, 10, 1}});
  REQUIRE(complex.insert(section));
  const auto again = complex.insert(section);
  REQUIRE(again);
  CHECK(again->lower.empty());
  CHECK(again->too_thin == again->reached);
  CHECK(complex.cell_count() == 2);
}

TEST_CASE("cells: a slice cuts the cells it crosses, keeps their ids below and brings its labels to both sides") {
  CellComplex complex(kBox, 0.01);
  REQUIRE(complex.insert(test::section_of_discs(test::frame_at({0, 0, 0}, {0, 0, 1}), {{{0, 0}, 20, 1}})));
  const auto delta = complex.insert(test::section_of_discs(test::frame_at({0, 0, 0}, {1, 0, 0}), {{{0, 0}, 20, 1}}));
  REQUIRE(delta);
  CHECK(delta->lower == std::vector<CellId>{CellId{0}, CellId{1}});
  CHECK(delta->upper == std::vector<CellId>{CellId{2}, CellId{3}});
  CHECK(complex.validate() == "");
  const double disc = 0.5 * 48 * 400.0 * std::sin(2 * std::numbers::pi / 48);
  for (std::uint32_t cell = 0; cell < 4; ++cell) {
    const auto faces = faces_of(complex, CellId{cell});
    CHECK(complex.volume(CellId{cell}) == doctest::Approx(250000.0));
    double labelled = 0.0;
    for (const CellFace& face : faces) labelled += area(*face.polygon, 1);
    CHECK(labelled == doctest::Approx(disc));
  }
}

TEST_CASE("cells: walls keep each label's area over 30 planes in free orientations") {
  CellComplex complex(kBox, 1e-3);
  std::mt19937 rng(7);
  double expected = 0.0;
  for (int i = 0; i < 30; ++i) {
    const Section section = test::section_of_discs(test::random_frame(rng, 15), {{{0, 0}, 12, 1}, {{-17, 3}, 2.5, 2}});
    const auto delta = complex.insert(section);
    REQUIRE(delta);
    CHECK(delta->reached >= delta->lower.size());
    expected += 0.5 * 48 * 144.0 * std::sin(2 * std::numbers::pi / 48);
  }
  CHECK(complex.validate() == "");
  double seen = 0.0;
  double covered = 0.0;
  for (std::uint32_t cell = 0; cell < complex.cell_count(); ++cell) {
    const Eigen::AlignedBox3d bounds = complex.bounds(CellId{cell});
    CHECK(bounds.contains(complex.centre(CellId{cell})));
    covered += complex.volume(CellId{cell});
    for (const CellFace& face : faces_of(complex, CellId{cell})) seen += 0.5 * area(*face.polygon, 1);
  }
  MESSAGE(complex.cell_count() << " cells, " << complex.face_count() << " faces, " << complex.edge_count() << " edges");
  CHECK(covered == doctest::Approx(1e6).epsilon(1e-9));
  CHECK(seen == doctest::Approx(expected).epsilon(1e-4));  // cells thinner than the gap are not cut
}

TEST_CASE("cells: locating many points agrees with locating one, and the cell contains the point") {
  CellComplex complex(kBox, 0.01);
  std::mt19937 rng(11);
  for (int i = 0; i < 20; ++i)
    (void)complex.insert(test::section_of_discs(test::random_frame(rng, 20), {{{0, 0}, 9, 1}}));
  std::uniform_real_distribution<double> uniform(-20.0, 20.0);
  std::vector<Eigen::Vector3d> points(5000);
  Eigen::AlignedBox3d bounds;
  for (Eigen::Vector3d& p : points) {
    p = Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng));
    bounds.extend(p);
  }
  std::vector<std::uint32_t> order;
  std::vector<CellPoints> groups;
  complex.locate(bounds, points, order, groups);
  std::size_t located = 0;
  std::size_t disagree = 0;
  std::size_t out_of_cell = 0;
  std::vector<CellFace> faces;
  for (const CellPoints& group : groups) {
    complex.faces(group.cell, faces);
    CHECK(group.first == located);
    located += group.count;
    for (std::uint32_t i = group.first; i < group.first + group.count; ++i) {
      const Eigen::Vector3d& p = points[order[i]];
      disagree += group.cell != complex.locate(p);
      for (const CellFace& face : faces)
        out_of_cell += (face.image_to_reference->inverse() * p).z() * (face.above ? 1.0 : -1.0) < -1e-9;
    }
  }
  CHECK(located == points.size());
  CHECK(disagree == 0);
  CHECK(out_of_cell == 0);
}

TEST_CASE("cells: points in rows lie in the cells that one point after the other lies in, each once") {
  CellComplex complex(kBox, 0.01);
  std::mt19937 rng(12);
  for (int i = 0; i < 20; ++i)
    (void)complex.insert(test::section_of_discs(test::random_frame(rng, 20), {{{0, 0}, 9, 1}}));
  std::vector<PointRow> rows;
  std::vector<RowPiece> all;
  for (std::uint32_t r = 0; r < 60; ++r) {
    const Eigen::Isometry3d frame = test::random_frame(rng, 20);
    rows.push_back({frame.translation(), r == 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(frame.linear().col(0))});
    all.push_back({r, 0, 12});
    all.push_back({r, 15, 16});
  }
  std::vector<RowPiece> pieces = all;
  std::vector<CellPieces> groups;
  complex.locate_rows(rows, pieces, groups);
  std::vector<std::vector<int>> found(rows.size(), std::vector<int>(16, 0));
  std::size_t located = 0, disagree = 0;
  std::set<CellId> cells;
  for (const CellPieces& group : groups) {
    CHECK(group.first == located);
    CHECK(cells.insert(group.cell).second);
    located += group.count;
    for (std::uint32_t k = group.first; k < group.first + group.count; ++k)
      for (std::uint32_t i = pieces[k].begin; i < pieces[k].end; ++i) {
        ++found[pieces[k].row][i];
        disagree += group.cell != complex.locate(rows[pieces[k].row].first + i * rows[pieces[k].row].step);
      }
  }
  CHECK(located == pieces.size());
  CHECK(disagree == 0);
  CHECK(cells.size() > 50);
  for (const auto& row : found)
    for (int i = 0; i < 16; ++i) CHECK(row[static_cast<std::size_t>(i)] == (i < 12 || i == 15 ? 1 : 0));
}

TEST_CASE(
    "cells: a segment touches every cell that its points lie in, and those on both sides of a wall that it lies in") {
  CellComplex complex(kBox, 0.01);
  std::mt19937 rng(5);
  for (int i = 0; i < 12; ++i)
    REQUIRE(complex.insert(test::section_of_discs(test::random_frame(rng, 20), {{{0, 0}, 15, 1}})));
  std::vector<CellId> touched;
  std::size_t several = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d a = test::random_frame(rng, 30).translation(), b = test::random_frame(rng, 30).translation();
    touched.clear();
    complex.touching(a, b, touched);
    several += touched.size() > 1 ? 1 : 0;
    for (int k = 0; k <= 100; ++k) {
      const CellId in = complex.locate(a + 0.01 * k * (b - a));
      CHECK(std::count(touched.begin(), touched.end(), in) == 1);
    }
  }
  CHECK(several > 100);
  for (const SliceId slice : complex.slices()) {
    const Eigen::Isometry3d& frame = complex.section(slice).image_to_reference;
    touched.clear();
    complex.touching(frame * Eigen::Vector3d(1, 2, 0), frame * Eigen::Vector3d(1.001, 2, 0), touched);
    const Eigen::Vector3d normal = frame.linear().col(2), middle = frame * Eigen::Vector3d(1.0005, 2, 0);
    for (const double side : {-1e-4, 1e-4})
      CHECK(std::count(touched.begin(), touched.end(), complex.locate(middle + side * normal)) == 1);
  }
}

TEST_CASE("cells: a slice with a bounded view cuts only the cells that its known part reaches") {
  CellComplex complex(kBox, 0.01);
  REQUIRE(complex.insert(test::section_of_discs(test::frame_at({0, 0, 0}, {1, 0, 0}), {{{0, 0}, 5, 1}})));
  // Known: a disc on the far side of the first plane only; all else of the second plane was not seen.
  Section view = test::section_of_discs(test::frame_at({0, 0, 0}, {0, 0, 1}), {{{25, 0}, 10, kOutside}});
  test::bound_view(view);
  const auto delta = complex.insert(view);
  REQUIRE(delta);
  CHECK(delta->lower == std::vector<CellId>{CellId{1}});
  CHECK(complex.cell_count() == 3);
  CHECK(complex.validate() == "");
}

TEST_CASE("cells: planes nearer than the gap merge into the first") {
  CellComplex complex(kBox, 0.5);
  REQUIRE(complex.insert(test::section_of_discs(test::frame_at({0, 0, 0}, {0, 0, 1}), {{{0, 0}, 5, 1}})));
  const auto merged = complex.insert(test::section_of_discs(test::frame_at({0, 0, 0.3}, {0, 0, 1}), {{{0, 0}, 5, 1}}));
  // The upper cell is 50 mm thick, but its part below the new plane only 0.3 mm.
  REQUIRE(merged);
  CHECK(merged->lower.empty());
  CHECK(merged->too_thin == 1);
  CHECK(complex.insert(test::section_of_discs(test::frame_at({0, 0, 0.7}, {0, 0, 1}), {{{0, 0}, 5, 1}})));
  CHECK(complex.cell_count() == 3);
}
