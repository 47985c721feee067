#include "device_sim/probe/label_noise.h"

#include <doctest/doctest.h>

#include "device_sim/probe/field_of_view.h"
#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

/// Two labels that share the view by halves.
PhantomSection halves() {
  return {{{-100, 0}, {0, 0}, {0, 100}, {-100, 100}, {0, 0}, {100, 0}, {100, 100}, {0, 100}},
          {{0, 4, 1, false}, {4, 4, 2, false}}};
}

double wrong_share(const PhantomSection& noisy, std::span<const Eigen::Vector2d> view) {
  const PhantomSection truth = halves();
  Random random(8);
  int wrong = 0, points = 0;
  while (points < 4000) {
    const Eigen::Vector2d p(124 * random.uniform() - 62, 62 * random.uniform());
    if (!encloses(view, p)) continue;
    ++points;
    wrong += test::label_in_section(noisy, p) != test::label_in_section(truth, p);
  }
  return static_cast<double>(wrong) / points;
}

}  // namespace

TEST_CASE("label noise: discs make the asked share of what is seen wrong") {
  const auto view = field_of_view(kConvexArray, {}, {});
  for (const double share : {0.01, 0.05}) {
    Random random(3);
    double sum = 0;
    constexpr int kSlices = 60;
    for (int i = 0; i < kSlices; ++i) {
      PhantomSection section = halves();
      add_wrong_discs(share, 2.5, view, random, section);
      CHECK(test::well_formed(section));
      sum += wrong_share(section, view) / kSlices;
    }
    MESSAGE("asked for " << share << ", measured " << sum);
    // Discs overlap, hang out of the view, and on a border say what is true beyond it.
    CHECK(sum < share);
    CHECK(sum > 0.7 * share);
  }
}

TEST_CASE("label noise: a section without a label stays without one") {
  Random random(3);
  PhantomSection section;
  add_wrong_discs(0.5, 2.5, field_of_view(kConvexArray, {}, {}), random, section);
  CHECK(section.loops.empty());
}
