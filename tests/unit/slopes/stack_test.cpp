#include <doctest/doctest.h>

#include "core/slopes/contour_slopes.h"
#include "tests/support/planes.h"
#include "tests/support/slopes/sloped_slices.h"

namespace sonoloft {
namespace {

constexpr double kFeature = 1.5;

Section circle(double height, double radius, double up = 1) {
  return test::section_of_discs(test::frame_at({0, 0, height}, {0, 0, up}), {{{0, 0}, radius, 1}}, 300);
}

TEST_CASE("slopes: a cone cut by parallel slices has its slope on all of them, seen along their normals") {
  test::SlopedSlices s(kFeature);
  const double slope = -0.6;
  const SliceId below = s.add(circle(-10, 30 - slope * 10)), middle = s.add(circle(0, 30));
  const SliceId above = s.add(circle(7, 30 + slope * 7, -1));
  (void)s.slopes.update(s.cells, 1);
  for (const SliceId slice : {below, middle, above}) {
    const double expected = slice == above ? -slope : slope;
    for (const VertexBend& bend : s.slopes.bends(slice)) CHECK(bend.slope == doctest::Approx(expected).epsilon(2e-3));
  }
}

TEST_CASE("slopes: a cylinder has none, and the curvature of its circle") {
  test::SlopedSlices s(kFeature);
  s.add(circle(-10, 30));
  const SliceId middle = s.add(circle(0, 30));
  s.add(circle(12, 30));
  (void)s.slopes.update(s.cells, 1);
  const Section& section = s.cells.section(middle);
  for (std::size_t i = 0; i < section.points.size(); ++i) {
    const VertexBend& bend = s.slopes.bends(middle)[i];
    CHECK(std::abs(bend.slope) < 2e-3);
    CHECK(bend.curvature_per_mm * 30 == doctest::Approx(1).epsilon(2e-3));
    CHECK((bend.outward.cast<double>() - section.points[i] / 30).norm() < 1e-3);
  }
}

TEST_CASE("slopes: between unequal gaps a sphere's slope is that of the cubic through three slices") {
  test::SlopedSlices s(kFeature);
  const auto radius = [](double height) { return std::sqrt(30 * 30 - height * height); };
  s.add(circle(2, radius(2)));
  const SliceId middle = s.add(circle(10, radius(10)));
  s.add(circle(14, radius(14)));
  (void)s.slopes.update(s.cells, 1);
  // Depths are differences of radii here: the weights 1 / h of the two gaps, without what the bracket takes away.
  const double down = (radius(10) - radius(2)) / 8, up = (radius(14) - radius(10)) / 4;
  const double expected = (down / 8 + up / 4) / (1.0 / 8 + 1.0 / 4);
  for (const VertexBend& bend : s.slopes.bends(middle)) CHECK(bend.slope == doctest::Approx(expected).epsilon(0.03));
  MESSAGE("slope ", s.slopes.bends(middle)[0].slope, ", of the sphere ", -10 / radius(10));
  CHECK(s.slopes.bends(middle)[0].slope == doctest::Approx(-10 / radius(10)).epsilon(0.05));
}

TEST_CASE("slopes: a slice alone, and what others do not reach, has none") {
  test::SlopedSlices s(kFeature);
  const SliceId alone = s.add(circle(0, 30));
  s.add(test::section_of_discs(test::frame_at({0, 0, 5}, {0, 0, 1}), {{{120, 0}, 20, 1}}));
  (void)s.slopes.update(s.cells, 1);
  for (const VertexBend& bend : s.slopes.bends(alone)) {
    CHECK(bend.slope == 0);
    CHECK(bend.curvature_per_mm > 0);
  }
}

TEST_CASE("slopes: what a slice did not see says nothing, and its border is no surface") {
  test::SlopedSlices s(kFeature);
  const SliceId below = s.add(circle(-10, 36)), middle = s.add(circle(0, 30));
  Section blind = circle(10, 10);
  test::bound_view(blind);
  const SliceId above = s.add(blind);
  (void)s.slopes.update(s.cells, 1);
  for (const VertexBend& bend : s.slopes.bends(middle)) CHECK(bend.slope == doctest::Approx(-0.6).epsilon(2e-3));
  for (const VertexBend& bend : s.slopes.bends(above)) CHECK(bend == VertexBend{});
  CHECK(s.slopes.bends(below).size() == 300);
}

}  // namespace
}  // namespace sonoloft
