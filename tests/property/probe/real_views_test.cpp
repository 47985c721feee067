// Everything that is wrong with a real acquisition at once: what the host gets are slices all the same.
#include <doctest/doctest.h>

#include "core/slice/section.h"
#include "device_sim/probe/phantoms/solid_phantom.h"
#include "tests/support/probe_slices.h"

using namespace sonoloft;
namespace sim = device_sim;

namespace {

sim::ProbeOptions everything_wrong() {
  sim::ProbeOptions options;
  options.sector = sim::kConvexArray;
  options.shadowing = {static_cast<Label>(sim::Organ::tumour)};
  options.tracker_rms_mm = options.tracker_rms_deg = 0.2;
  options.tracker_bias_mm = 2;
  options.contour_rms_mm = 0.5;
  options.wrong_share = 0.05;
  options.contact_lost_share = 0.1;
  return options;
}

}  // namespace

TEST_CASE("probe: shadowed, noisy, wrong and partly unseen slices are sections, with unknown around what was seen") {
  const auto organs = std::make_shared<const sim::SolidPhantom>(sim::organs_phantom());
  auto probe = sim::SimulatedProbe::make(everything_wrong(), organs,
                                         sim::pass_sweep(organs->bounds(), {150, 0.0}, 30, sim::Hand{}));
  REQUIRE_MESSAGE(probe.value, probe.error);
  std::size_t known = 0, points = 0;
  for (const TrackedSlice& slice : test::slices_of(*probe.value)) {
    const auto section = make_section(slice);
    REQUIRE_MESSAGE(section, section.error().message);
    CHECK(section->border == kUnknown);
    Eigen::AlignedBox2d view;
    for (const Eigen::Vector2d& p : slice.field_of_view) view.extend(p);
    sim::Random random(slice.id);
    for (int i = 0; i < 50; ++i) {
      const double x = random.uniform(), y = random.uniform();
      const Eigen::Vector2d p = view.min() + Eigen::Vector2d(x, y).cwiseProduct(view.sizes());
      const bool is_known = label_at(*section, p) != kUnknown;
      CHECK(is_known == sim::encloses(slice.field_of_view, p));
      known += is_known;
      ++points;
    }
  }
  MESSAGE(known << " of " << points << " points around the views are known");
  CHECK(known > points / 3);
  CHECK(known < points * 3 / 4);
}
