#include "host/igtl/scene/label_surfaces.h"

#include <doctest/doctest.h>

#include "tests/support/twin_boxes.h"
#include "tests/unit/igtl/closed_surface.h"

using namespace sonoloft;
using namespace sonoloft::test;

TEST_CASE("label surfaces: every label is closed, points outwards, and is turned to RAS") {
  const auto surfaces = igtl::label_surfaces(twin_boxes().indexed());
  REQUIRE(surfaces.size() == 2);
  CHECK(surfaces[0].label == 2);
  CHECK(surfaces[1].label == 5);
  for (const auto& surface : surfaces) {
    CHECK(surface.points.size() == 8);
    CHECK(surface.triangles.size() == 12);
    CHECK(is_closed(surface.triangles));
  }
  CHECK(volume(surfaces[0].points, surfaces[0].triangles) == doctest::Approx(6));
  CHECK(volume(surfaces[1].points, surfaces[1].triangles) == doctest::Approx(12));
  for (const auto& [x, y, z] : surfaces[0].points) {  // x in 0..1, y in 0..2, z in 0..3 in LPS
    CHECK(x <= 0);
    CHECK(x >= -1);
    CHECK(y <= 0);
    CHECK(z >= 0);
  }
}

TEST_CASE("label surfaces: a mesh without triangles has none") {
  CHECK(igtl::label_surfaces({}).empty());
}
