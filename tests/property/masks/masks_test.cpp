#include "tests/support/masks.h"

#include <doctest/doctest.h>

#include "core/slice/section.h"
#include "device_sim/probe/random.h"
#include "tests/support/recorded_slices.h"

using namespace sonoloft;
using test::Mask;

namespace {

struct Shares {
  double unknown;  ///< of the labelled area
  double changed;  ///< of all points, those whose label became another material
};

Shares shares_of(const TrackedSlice& whole, const TrackedSlice& masked) {
  const Section before = make_section(whole).value(), after = make_section(masked).value();
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : whole.points) box.extend(p);
  device_sim::Random random(77);
  int points = 0, labelled = 0, unknown = 0, changed = 0;
  for (; labelled < 1000; ++points) {
    const double x = random.uniform(), y = random.uniform();
    const Eigen::Vector2d p = box.min() + Eigen::Vector2d(x, y).cwiseProduct(box.sizes());
    const Label was = label_at(before, p), is = label_at(after, p);
    labelled += was != kOutside;
    unknown += was != kOutside && is == kUnknown;
    changed += is != kUnknown && is != was;
  }
  return {static_cast<double>(unknown) / labelled, static_cast<double>(changed) / points};
}

}  // namespace

TEST_CASE("masks: hide the asked share of every slice's labels and change none") {
  const auto file = test::read_recorded_slices("csl/Horsers.csl");
  if (!file) return;
  const std::vector<TrackedSlice>& slices = file->slices;
  const struct {
    Mask mask;
    double share;
  } cases[] = {
      {Mask::blobs, 0.05}, {Mask::blobs, 0.4}, {Mask::half_plane, 0.2}, {Mask::window, 0.4}, {Mask::window, 0.7}};
  for (const auto& c : cases) {
    const std::vector<TrackedSlice> masked = test::masked(slices, c.mask, c.share, 1);
    double mean = 0, worst = 0, changed = 0;
    for (std::size_t i = 0; i < slices.size(); ++i) {
      const Shares shares = shares_of(slices[i], masked[i]);
      mean += shares.unknown / static_cast<double>(slices.size());
      worst = std::max(worst, std::abs(shares.unknown - c.share));
      changed = std::max(changed, shares.changed);
    }
    MESSAGE("asked for " << c.share << ", hidden " << mean << ", off by at most " << worst);
    CHECK(mean == doctest::Approx(c.share).epsilon(0.1));
    CHECK(worst < 0.08);  // counted with 1000 points here and there
    CHECK(changed == 0);
  }
}

TEST_CASE("masks: the same seed gives the same masks, another one another") {
  const auto file = test::read_recorded_slices("csl/eight_20.csl");
  if (!file) return;
  for (const Mask mask : {Mask::blobs, Mask::half_plane, Mask::window}) {
    const auto one = test::masked(file->slices, mask, 0.4, 1), again = test::masked(file->slices, mask, 0.4, 1),
               other = test::masked(file->slices, mask, 0.4, 2);
    for (std::size_t i = 0; i < one.size(); ++i) {
      CHECK(one[i].field_of_view == again[i].field_of_view);
      CHECK(one[i].field_of_view != other[i].field_of_view);
    }
  }
}
