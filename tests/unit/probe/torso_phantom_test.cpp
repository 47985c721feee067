#include "device_sim/probe/phantoms/torso_phantom.h"

#include <doctest/doctest.h>

#include <numbers>
#include <set>

#include "device_sim/probe/field_of_view.h"
#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

TEST_CASE("torso: five labels, of which the spine lies deepest and a rib in front") {
  const SolidPhantom torso = torso_phantom();
  std::set<Label> seen;
  for (int i = 0; i < 40; ++i) {
    const double z = -80 + 4.0 * i;
    const PhantomSection section = torso.section(test::plane_at({0, 60, z}, {0, 0, 1}));
    CHECK(test::well_formed(section));
    for (const SectionLoop& loop : section.loops) seen.insert(loop.label);
  }
  CHECK(seen == std::set<Label>{1, 2, 3, 4, 5});
  CHECK(torso.label_at({0, 1, -5}) == static_cast<Label>(Torso::bone));
  CHECK(torso.label_at({0, 124, 0}) == static_cast<Label>(Torso::bone));
  CHECK(torso.label_at({0, 50, 8}) == static_cast<Label>(Torso::liver));
  CHECK(torso.label_at({0, 8, 8}) == kOutside);  // between two ribs
}

TEST_CASE("torso: its thinnest vessel is seen across, with its whole area") {
  const SolidPhantom torso = torso_phantom();
  const Eigen::Vector3d from(-22, 50, 6), to(-30, 56, 40);
  const PhantomSection section = torso.section(test::plane_at((from + to) / 2, to - from));
  double area = 0;
  for (const SectionLoop& loop : section.loops)
    if (loop.label == static_cast<Label>(Torso::vessel) && test::inside_loop(test::points_of(section, loop), {0, 0}))
      area = test::loop_area(test::points_of(section, loop));
  MESSAGE("area " << area << " mm2");
  CHECK(area == doctest::Approx(std::numbers::pi * 1.5 * 1.5).epsilon(0.1));
}

TEST_CASE("torso: bones hide a part of every pass, never all of it") {
  const SolidPhantom torso = torso_phantom();
  const Sector sector{8, 110, 35 * std::numbers::pi / 180};
  const Label bone[] = {static_cast<Label>(Torso::bone)};
  const double whole_mm2 = test::loop_area(field_of_view(sector, {}, {}));
  Hand steady;
  steady.tremor_deg = steady.tremor_mm = 0;
  const Trajectory passes = pass_sweep(torso.bounds(), {.slices = 100, .standoff_mm = 8}, 40, steady);
  for (std::size_t pass = 0; pass < 5; ++pass) {
    double hidden = 0;
    for (std::size_t i = 20 * pass; i < 20 * (pass + 1); ++i)
      hidden += (1 - test::loop_area(field_of_view(sector, torso.section(passes[i]), bone)) / whole_mm2) / 20;
    MESSAGE("pass " << pass << ": " << hidden << " of the sector hidden");
    CHECK(hidden > 0.1);
    CHECK(hidden < 0.8);
  }
}
