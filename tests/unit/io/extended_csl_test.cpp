#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/io/slices/slice_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/io/label_in_space.h"

using namespace sonoloft;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::label_in_space;

namespace {

/// A square of side 4 in z = 3, and z = 5 without a contour.
const std::string kPlain = "CSLC\n2 1\n1 4 1 0 0 1 -3\n0 0 3\n4 0 3\n4 4 3\n0 4 3\n4 1 0 1 2 3\n2 0 0 0 0 1 -5\n";
/// The first plane is seen for x < 3 but for a shadow around (1, 1), the second for x < 2.
const std::string kExtension =
    "CSLX 1 3\n"
    "view 0 4\n-1 -1 3\n3 -1 3\n3 5 3\n-1 5 3\n"
    "unknown 0 4\n0.5 0.5 3\n1.5 0.5 3\n1.5 1.5 3\n0.5 1.5 3\n"
    "view 1 3\n2 0 5\n2 4 5\n-2 0 5\n";

SliceFile read(const std::string& text) {
  auto file = parse_csl(text, "test.csl");
  REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
  return *file;
}

Vector3d in_space(const TrackedSlice& slice, const Vector2d& p) {
  return slice.image_to_reference * Vector3d(p.x(), p.y(), 0);
}

/// A slice far from the origin, askew: an organ with a vessel, a hole in it, a shadow over a part, a view.
TrackedSlice busy_slice() {
  TrackedSlice slice;
  slice.image_to_reference =
      Eigen::Translation3d(123.4, -567.8, 91.01) * Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized());
  const auto add_ring = [&](const Vector2d& middle, double radius, Label label, bool hole) {
    constexpr std::uint32_t kPoints = 40;
    slice.contours.push_back({static_cast<std::uint32_t>(slice.points.size()), kPoints, label, hole});
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const double angle = 2 * M_PI * i / kPoints;
      slice.points.push_back(middle + radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  };
  add_ring({30, 0}, 7, kOutside, true);
  add_ring({0, 0}, 60, 2, false);
  add_ring({-20, 10}, 4, 7, false);
  add_ring({10, -30}, 9, kUnknown, false);
  add_ring({30, 0}, 12, 3, false);
  slice.field_of_view = {{-70, -70}, {40, -70}, {40, 70}, {-70, 70}};
  return slice;
}

}  // namespace

TEST_CASE("extended csl: what is out of view or in an unknown region is unknown, the rest as the components say") {
  const SliceFile file = read(kPlain + kExtension);
  REQUIRE(file.slices.size() == 2);
  CHECK(!file.notes.trailing_text);
  CHECK(file.slices[0].field_of_view.size() == 4);
  CHECK(label_in_space(file.slices[0], {2, 2, 3}) == 1);
  CHECK(label_in_space(file.slices[0], {-0.5, 2, 3}) == kOutside);
  CHECK(label_in_space(file.slices[0], {1, 1, 3}) == kUnknown);
  CHECK(label_in_space(file.slices[0], {3.5, 2, 3}) == kUnknown);
  CHECK(file.slices[1].contours.empty());
  CHECK(label_in_space(file.slices[1], {1.5, 1, 5}) == kOutside);
  CHECK(label_in_space(file.slices[1], {2.5, 1, 5}) == kUnknown);
}

TEST_CASE("extended csl: without the extension it is a plain file, and other text behind it is left alone") {
  CHECK(read(kPlain).slices[0].field_of_view.empty());
  CHECK(!read(kPlain).notes.trailing_text);
  CHECK(read(kPlain + "made with love\n").notes.trailing_text);
  CHECK(read(kPlain + kExtension + "made with love\n").notes.trailing_text);
}

TEST_CASE("extended csl: images of one plane stay apart when they have a view") {
  std::string text = kPlain + kExtension;
  text.replace(text.find("0 0 1 -5"), 8, "0 0 1 -3");
  for (std::size_t at; (at = text.find(" 5\n", text.find("view 1"))) != std::string::npos;) text.replace(at, 3, " 3\n");
  const SliceFile file = read(text);
  CHECK(file.slices.size() == 2);
  CHECK(file.notes.merged_planes == 0);
}

TEST_CASE("extended csl: slices come back from a file as they were, point by point") {
  const std::vector<TrackedSlice> slices{busy_slice(), read(kPlain + kExtension).slices[1]};
  const test::TemporaryFolder folder;
  REQUIRE(write_csl(slices, folder.path("scan.csl")));
  const auto file = read_csl(folder.path("scan.csl"));
  REQUIRE_MESSAGE(file, file.error().message);
  REQUIRE(file->slices.size() == 2);
  const TrackedSlice &was = slices[0], &is = file->slices[0];
  REQUIRE(is.contours.size() == was.contours.size());
  double farthest = 0, largest = 0;
  const auto compare = [&](const Vector2d& p, const Vector2d& q) {
    farthest = std::max(farthest, (in_space(was, p) - in_space(is, q)).norm());
    largest = std::max(largest, in_space(was, p).cwiseAbs().maxCoeff());
  };
  // The unknown region comes last.
  const std::size_t order[] = {0, 1, 2, 4, 3};
  for (std::size_t i = 0; i < 5; ++i) {
    const Contour &a = was.contours[order[i]], &b = is.contours[i];
    CHECK(a.label == b.label);
    CHECK(a.hole == b.hole);
    REQUIRE(a.count == b.count);
    for (std::uint32_t k = 0; k < a.count; ++k) compare(was.points[a.first + k], is.points[b.first + k]);
  }
  REQUIRE(is.field_of_view.size() == was.field_of_view.size());
  for (std::size_t i = 0; i < is.field_of_view.size(); ++i) compare(was.field_of_view[i], is.field_of_view[i]);
  MESSAGE("farthest point " << farthest << " mm away, coordinates up to " << largest);
  CHECK(farthest <= 1e-12 * largest);
  CHECK((was.image_to_reference.linear().col(2) - is.image_to_reference.linear().col(2)).norm() < 1e-14);
  CHECK(file->slices[1].field_of_view.size() == 3);
  CHECK(file->slices[1].contours.empty());
}

TEST_CASE("extended csl: other readers find the component around a hole, and nothing unknown among the planes") {
  const std::vector<TrackedSlice> slices{busy_slice()};
  const std::string text = csl_text(slices);
  CHECK(text.find("\n40h3 0 ") != std::string::npos);  // of label 3, the fourth without the unknown one
  CHECK(text.find("65535") == std::string::npos);
  CHECK(text.starts_with("CSLC\n1 3\n"));
  const SliceFile plain = read(text.substr(0, text.find("CSLX")));
  CHECK(plain.slices[0].contours.size() == 4);
}

TEST_CASE("extended csl: a plane that was written once is written the same way again") {
  const std::vector<TrackedSlice> flat{read(kPlain + kExtension).slices};
  const std::string once = csl_text(flat), twice = csl_text(read(once).slices);
  CHECK(once == twice);
}
