#include "core/io/slices/slice_files.h"

#include <doctest/doctest.h>

#include <string>

#include "core/slice/section.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/io/label_in_space.h"

using namespace sonoloft;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::label_in_space;

namespace {

SliceFile csl(std::string_view text) {
  auto file = parse_csl(text, "test.csl");
  REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
  return *file;
}

SliceFile contour(std::string_view text) {
  auto file = parse_contour(text, "test.contour");
  REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
  return *file;
}

/// A square of side 4 with a square hole of side 2 in z = 3, with blank lines, blanks and CRLF.
const std::string kFramed =
    "CSLC\r\n\r\n 2 9 \r\n\r\n 1 8 2 0 0 2 -6\r\n\r\n0 0 3\r\n4 0 3\r\n4 4 3\r\n0 4 3\r\n 1 1 3\r\n 3 1 3 \r\n3 3 "
    "3\r\n1 3 3\r\n"
    "\r\n4 1 0 1 2 3 \r\n4h0 1 4 5 6 7\r\n\r\n2 0 0 1 0 0 -7\r\n\r\n";

/// Two labels side by side in z = 1, a soup of edges around two triple junctions.
std::string two_labels(std::string_view plane, std::string_view edges) {
  return "1\n" + std::string(plane) + "\n6 7\n0 0 1\n2 0 1\n4 0 1\n4 2 1\n2 2 1\n0 2 1\n" + std::string(edges);
}
constexpr std::string_view kEdges = "0 1 1 0\n1 2 2 0\n2 3 2 0\n3 4 2 0\n4 5 1 0\n5 0 1 0\n1 4 1 2\n";
constexpr std::string_view kEdgesFlipped = "0 1 0 1\n1 2 0 2\n2 3 0 2\n3 4 0 2\n4 5 0 1\n5 0 0 1\n1 4 2 1\n";

}  // namespace

TEST_CASE("csl: blank lines, blanks, CRLF and a normal of any length mean nothing") {
  const SliceFile file = csl(kFramed);
  REQUIRE(file.slices.size() == 2);
  const TrackedSlice& slice = file.slices[0];
  CHECK(slice.points.size() == 8);
  REQUIRE(slice.contours.size() == 2);
  CHECK(slice.contours[0].label == 1);
  CHECK(slice.contours[1].hole);
  CHECK((slice.image_to_reference * Vector3d(slice.points[1].x(), slice.points[1].y(), 0) - Vector3d(4, 0, 3)).norm() <
        1e-12);
  CHECK(slice.image_to_reference.linear().col(2) == Vector3d(0, 0, 1));
  CHECK((slice.image_to_reference.translation() - Vector3d(2, 2, 3)).norm() < 1e-12);
  CHECK(label_in_space(slice, {0.5, 0.5, 3}) == 1);
  CHECK(label_in_space(slice, {2, 2, 3}) == kOutside);
  CHECK(file.notes.scaled_normals == 1);
}

TEST_CASE("csl: a plane without contours stays: it says that all is outside there") {
  const SliceFile file = csl(kFramed);
  REQUIRE(file.slices.size() == 2);
  CHECK(file.slices[1].contours.empty());
  CHECK(file.slices[1].id == 1);
  CHECK((file.slices[1].image_to_reference.translation() - Vector3d(7, 2, 3)).norm() < 1e-12);
}

TEST_CASE("csl: a constant of the wrong sign is turned, also of planes without vertices beside them") {
  std::string text = kFramed;
  text.at(text.find("-6")) = '+';
  text.at(text.find("-7")) = '+';
  const SliceFile file = csl(text);
  CHECK(file.notes.flipped_offsets == 1);
  CHECK(file.notes.largest_offset_mm < 1e-12);
  CHECK(label_in_space(file.slices[0], {0.5, 0.5, 3}) == 1);
  CHECK((file.slices[1].image_to_reference.translation() - Vector3d(7, 2, 3)).norm() < 1e-12);
}

TEST_CASE("csl: vertices a little off their plane are projected") {
  std::string text = kFramed;
  text.replace(text.find("4 4 3"), 5, "4 4 3.03");
  const SliceFile file = csl(text);
  CHECK(file.notes.moved_vertices == 1);
  CHECK(file.notes.largest_offset_mm == doctest::Approx(0.03));
  CHECK(label_in_space(file.slices[0], {3.9, 3.9, 3}) == 1);
}

TEST_CASE("csl: two planes in one place become one slice, also when they look at each other") {
  const SliceFile file = csl(
      "CSLC 2 1  1 3 1 0 0 1 0  0 0 0  4 0 0  0 4 0  3 1 0 1 2   2 3 1 0 0 -2 0  -9 0 0  -8 0 0  -9 1 0  3 2 0 1 2");
  REQUIRE(file.slices.size() == 1);
  CHECK(file.notes.merged_planes == 1);
  CHECK(file.slices[0].contours.size() == 2);
  CHECK(label_in_space(file.slices[0], {1, 1, 0}) == 1);
  CHECK(label_in_space(file.slices[0], {-8.8, 0.1, 0}) == 2);
}

TEST_CASE("csl: components of fewer than three vertices are dropped, text behind the last plane is noted") {
  const SliceFile file = csl("CSLC 1 1  1 3 2 0 0 1 0  0 0 0  4 0 0  0 4 0  2 1 0 1  3 1 0 1 2  and more");
  CHECK(file.slices[0].contours.size() == 1);
  CHECK(file.notes.dropped_components == 1);
  CHECK(file.notes.trailing_text);
}

TEST_CASE("contour: the loops of every label are traced, with either sign of d and either side called left") {
  for (const std::string_view plane : {"0 0 1 -1", "0 0 1 1", "0 0 -1 1", "0 0 -3 -3"})
    for (const std::string_view edges : {kEdges, kEdgesFlipped}) {
      const SliceFile file = contour(two_labels(plane, edges));
      REQUIRE(file.slices.size() == 1);
      CHECK(file.slices[0].contours.size() == 2);
      CHECK(label_in_space(file.slices[0], {1, 1, 1}) == 1);
      CHECK(label_in_space(file.slices[0], {3, 1, 1}) == 2);
      CHECK(label_in_space(file.slices[0], {5, 1, 1}) == kOutside);
      CHECK(file.notes.flipped_offsets == ((plane == "0 0 1 1" || plane == "0 0 -3 -3") ? 1 : 0));
      CHECK(file.notes.flipped_sides == ((edges == kEdges) == plane.starts_with("0 0 1") ? 0 : 1));
      CHECK(make_section(file.slices[0])->edges.size() == 7);
    }
}

TEST_CASE("contour: a region with a hole, an island in it, and regions that touch in one vertex") {
  // Label 1: [0,6]^2 without [1,3]^2 and with the island [1.5,2.5]^2; label 2 touches it in the corner (6,6).
  const SliceFile file = contour(
      "1\n0 0 1 0\n15 16\n0 0 0\n6 0 0\n6 6 0\n0 6 0\n1 1 0\n3 1 0\n3 3 0\n1 3 0\n1.5 1.5 0\n2.5 1.5 0\n2.5 2.5 0\n"
      "1.5 2.5 0\n8 6 0\n8 8 0\n6 8 0\n0 1 1 0\n1 2 1 0\n2 3 1 0\n3 0 1 0\n4 5 0 1\n5 6 0 1\n6 7 0 1\n7 4 0 1\n"
      "8 9 1 0\n9 10 1 0\n10 11 1 0\n11 8 1 0\n2 12 1 0\n12 13 1 0\n13 14 1 0\n14 2 1 0\n");
  const TrackedSlice& slice = file.slices[0];
  CHECK(slice.contours.size() == 4);
  CHECK(label_in_space(slice, {0.5, 0.5, 0}) == 1);
  CHECK(label_in_space(slice, {1.2, 1.2, 0}) == kOutside);
  CHECK(label_in_space(slice, {2, 2, 0}) == 1);
  CHECK(label_in_space(slice, {7, 7, 0}) == 1);
  CHECK(label_in_space(slice, {7, 5, 0}) == kOutside);
  CHECK(file.notes.flipped_sides == 0);
}

TEST_CASE("slice files: they are read from disk under their own name") {
  const test::TemporaryFolder folder;
  const auto file = read_csl(folder.write("framed.csl", kFramed));
  REQUIRE(file.has_value());
  CHECK(file->slices.size() == 2);
  CHECK(read_contour(folder.write("two.contour", two_labels("0 0 1 -1", kEdges)))->slices.size() == 1);
  const auto bad = read_csl(folder.write("bad.csl", "CSLC\n1 1\n1 3 1 0 0 1 0\n0 0 zero\n"));
  REQUIRE_FALSE(bad.has_value());
  CHECK(bad.error().message == "bad.csl:4: a coordinate is no number: mend the line");
  CHECK(read_csl(folder.path("none.csl")).error().code == ErrorCode::file_not_found);
  CHECK(read_csl(folder.path(".")).error().code == ErrorCode::io_failed);
}
