#include "device_sim/probe/field_of_view.h"

#include <doctest/doctest.h>

#include <numbers>

#include "device_sim/probe/phantoms/solid_phantom.h"
#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

using Polygon = std::vector<Eigen::Vector2d>;
constexpr double kRadian = std::numbers::pi / 180;

Polygon square(double x, double y, double half) {
  return {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}};
}

}  // namespace

TEST_CASE("field of view: the polygon has the area of the sector") {
  const Sector sector{10, 80, 35 * kRadian};
  const Polygon polygon = field_of_view(sector, {}, {});
  CHECK(test::loop_area(polygon) == doctest::Approx(35 * kRadian * (6400 - 100)).epsilon(1e-3));
  CHECK(test::inside_loop(polygon, {0, 79}));
  CHECK(!test::inside_loop(polygon, {0, 9}));
  CHECK(!test::inside_loop(polygon, {60, 30}));
  CHECK(test::loop_area(field_of_view({0, 80, 35 * kRadian}, {}, {})) ==
        doctest::Approx(35 * kRadian * 6400).epsilon(1e-3));
}

TEST_CASE("field of view: the covering sector sees the whole section at every pose of every sweep") {
  const SolidPhantom phantom = organs_phantom();
  const SweepOptions options{.slices = 12, .standoff_mm = {}};
  for (const Trajectory& trajectory :
       {linear_sweep(phantom.bounds(), options), fan_sweep(phantom.bounds(), options),
        rotation_sweep(phantom.bounds(), options), freehand_sweep(phantom.bounds(), options, Hand{})}) {
    const Sector sector = covering_sector(phantom.bounds(), trajectory);
    const Polygon polygon = field_of_view(sector, {}, {});
    int unseen = 0, points = 0;
    for (const Eigen::Isometry3d& face : trajectory) {
      for (const Eigen::Vector2d& p : phantom.section(face).points) {
        ++points;
        unseen += !test::inside_loop(polygon, p);
      }
    }
    CHECK(points > 1000);
    CHECK(unseen == 0);
  }
}

TEST_CASE("field of view: behind a label that sound does not pass nothing is seen") {
  const Sector sector{10, 100, 40 * kRadian};
  PhantomSection section;
  section.points = square(0, 50, 8);
  section.loops = {{0, 4, 6, false}};
  const Label bone[] = {6}, flesh[] = {1};
  const Polygon shadowed = field_of_view(sector, section, bone);
  CHECK(test::inside_loop(shadowed, {0, 41}));
  CHECK(test::inside_loop(shadowed, {0, 42 + kShadowSkinMm - 0.1}));
  CHECK(!test::inside_loop(shadowed, {0, 42 + kShadowSkinMm + 0.1}));
  CHECK(!test::inside_loop(shadowed, {0, 90}));
  CHECK(test::inside_loop(shadowed, {30, 80}));
  CHECK(test::loop_area(field_of_view(sector, section, flesh)) == test::loop_area(field_of_view(sector, {}, {})));
  // A probe that stands on bone sees its skin.
  section.points = square(0, 10, 8);
  const Polygon covered = field_of_view(sector, section, bone);
  CHECK(test::inside_loop(covered, {0, 10 + kShadowSkinMm - 0.1}));
  CHECK(!test::inside_loop(covered, {0, 10 + kShadowSkinMm + 0.1}));
}

TEST_CASE("field of view: beams without contact see nothing, the others what they saw") {
  const Polygon whole = field_of_view(kConvexArray, {}, {}), part = field_of_view(kConvexArray, {}, {}, {0.25, 0.9});
  CHECK(test::loop_area(part) == doctest::Approx(0.65 * test::loop_area(whole)).epsilon(2e-3));
  const auto at = [](double degrees) -> Eigen::Vector2d {
    return 40 * Eigen::Vector2d(std::sin(degrees * kRadian), std::cos(degrees * kRadian));
  };
  CHECK(!test::inside_loop(part, at(-16)));
  CHECK(test::inside_loop(part, at(-14)));
  CHECK(test::inside_loop(part, at(23)));
  CHECK(!test::inside_loop(part, at(25)));
  CHECK(field_of_view(kConvexArray, {}, {}, {0.4999, 0.5001}).size() >= 4);
}

TEST_CASE("field of view: has few corners where nothing shadows, and is exact to 1/2000 of its depth") {
  const Polygon view = field_of_view(kConvexArray, {}, {});
  MESSAGE(view.size() << " corners");
  CHECK(view.size() < 30);
  for (const Eigen::Vector2d& p : view) CHECK(std::min(std::abs(p.norm() - 4), std::abs(p.norm() - 62)) < 1e-9);
  for (std::size_t i = 0; i < view.size(); ++i) {
    const Eigen::Vector2d middle = (view[i] + view[(i + 1) % view.size()]) / 2;
    if (middle.norm() > 61) CHECK(middle.norm() > 62 - 62.0 / 2000);
  }
}

TEST_CASE("field of view: loops overlap it when they cross, hold or lie in it") {
  const Polygon view = field_of_view({10, 100, 40 * kRadian}, {}, {});
  CHECK(overlaps(square(0, 50, 5), view));                          // within
  CHECK(overlaps(square(0, 50, 500), view));                        // all around
  CHECK(overlaps(square(0, 105, 10), view));                        // over the far arc
  CHECK(overlaps(Polygon{{-300, 50}, {300, 50}, {0, 300}}, view));  // no corner of either within the other's
  CHECK(!overlaps(square(0, 2, 3), view));                          // between apex and near arc
  CHECK(!overlaps(square(80, 40, 5), view));                        // beside, within the box around
  CHECK(!overlaps(square(500, 50, 5), view));
}
