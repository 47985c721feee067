#include <doctest/doctest.h>

#include "core/slopes/contour_slopes.h"
#include "core/slopes/crossings.h"
#include "tests/support/planes.h"
#include "tests/support/slopes/ellipsoid.h"
#include "tests/support/slopes/sloped_slices.h"

namespace sonoloft {
namespace {

using Eigen::Vector3d;

/// A long body with the surface normal . x = 10 in front, in which the contours run across the y axis.
Section block(const Eigen::Isometry3d& frame, const Vector3d& normal) {
  Section section;
  section.image_to_reference = frame;
  const auto corner = [&](double y, double depth) {  // on the image's line of that y where normal . x = 10 - depth
    const Vector3d along = frame.linear().col(0);
    const double x = (10 - depth - y * normal.dot(frame.linear().col(1))) / normal.dot(along);
    section.points.emplace_back(x, y);
  };
  constexpr int kPieces = 160;
  for (int i = 0; i <= kPieces; ++i) corner(-80 + i, 0);
  corner(80, 60);
  corner(-80, 60);
  const auto count = static_cast<std::uint32_t>(section.points.size());
  for (std::uint32_t i = 0; i < count; ++i) section.edges.push_back({i, (i + 1) % count, 1, kOutside});
  return section;
}

TEST_CASE("slopes: a tilted plane in a wedge is found from either of its slices, however they lean") {
  const Vector3d normal = Vector3d(1, 0, 0.5).normalized();
  for (const double degrees : {15.0, 25.0, -40.0}) {
    const double turn = degrees * std::numbers::pi / 180;
    Eigen::Isometry3d tilted = Eigen::Isometry3d::Identity();
    tilted.linear() = Eigen::AngleAxisd(turn, Vector3d::UnitY()).toRotationMatrix();
    test::SlopedSlices s(1.5);
    for (const Eigen::Isometry3d& frame : {Eigen::Isometry3d::Identity(), tilted}) s.add(block(frame, normal));
    (void)s.slopes.update(s.cells, 1);
    for (const SliceId slice : s.cells.slices()) {
      const double expected = test::slope_of(normal, s.cells.section(slice).image_to_reference.linear().col(2));
      CAPTURE(degrees);
      for (std::size_t i = 40; i <= 120; ++i)
        CHECK(s.slopes.bends(slice)[i].slope == doctest::Approx(expected).epsilon(0.04));  // sides far off take part
    }
  }
}

TEST_CASE("slopes: where contours cross, the surface of both is known at once") {
  const test::Ellipsoid ball{{30, 30, 30}};
  test::SlopedSlices s(1.5);
  s.add(ball.cut(test::frame_at({0, 0, 12}, {0, 0, 1}), 400));
  s.add(ball.cut(test::frame_at({5, 0, 0}, {1, 0, 0}), 400));
  (void)s.slopes.update(s.cells, 1);
  for (const SliceId slice : s.cells.slices()) {
    const Section& section = s.cells.section(slice);
    const Vector3d plane = section.image_to_reference.linear().col(2);
    int near = 0;
    for (std::size_t i = 0; i < section.points.size(); ++i) {
      const Vector3d at = section.image_to_reference * Vector3d(section.points[i].x(), section.points[i].y(), 0);
      if (std::abs(at.x() - 5) > 0.3 || std::abs(at.z() - 12) > 0.3) continue;
      ++near;
      CHECK(s.slopes.bends(slice)[i].slope == doctest::Approx(test::slope_of(ball.normal(at), plane)).epsilon(0.02));
    }
    CHECK(near >= 2);
  }
}

/// How many crossings two slices have, both on walls all over.
std::size_t crossing_count(const Section& a, const Section& b) {
  constexpr double kFeature = 1.5;
  std::vector<SliceContours> contours;
  for (const Section& section : {a, b}) {
    contours.emplace_back(section, kFeature);
    for (auto& [below, above] : contours.back().sums) below.cell = above.cell = 0;
  }
  const auto [of_a, of_b] = crossings_of(SliceId{0}, contours[0], SliceId{1}, contours[1], kFeature);
  CHECK(of_a.size() == of_b.size());
  return of_a.size();
}

TEST_CASE("slopes: contours that miss each other, of other labels or in nearly the same plane, do not cross") {
  const test::Ellipsoid ball{{30, 30, 30}};
  const Section flat = ball.cut(test::frame_at({0, 0, 12}, {0, 0, 1}), 400);
  const Section upright = ball.cut(test::frame_at({5, 0, 0}, {1, 0, 0}), 400);
  CHECK(crossing_count(flat, upright) == 2);
  Section wide = upright, other = upright;
  for (Eigen::Vector2d& p : wide.points) p *= 1.1;
  for (SectionEdge& e : other.edges) e.left = 2;
  CHECK(crossing_count(flat, wide) == 0);
  CHECK(crossing_count(flat, other) == 0);
  CHECK(crossing_count(flat, ball.cut(test::frame_at({0, 0, 12}, {0.05, 0, 1}), 400)) == 0);
}

}  // namespace
}  // namespace sonoloft
