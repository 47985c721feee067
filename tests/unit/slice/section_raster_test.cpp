#include "core/slice/section_raster.h"

#include <doctest/doctest.h>

#include <random>

#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

const Eigen::AlignedBox3d kBox(Eigen::Vector3d(-30, -25, -20), Eigen::Vector3d(35, 30, 40));

/// Contours that cross each other and themselves at random, every fourth slice through a bounded field of view.
Section tangle(std::mt19937& rng, int kind) {
  std::uniform_real_distribution<double> place(-28, 28);
  TrackedSlice slice;
  slice.image_to_reference = test::random_frame(rng, 15);
  for (Label label : {Label{1}, Label{2}, kUnknown}) {
    slice.contours.push_back({static_cast<std::uint32_t>(slice.points.size()), 9, label, false});
    for (int i = 0; i < 9; ++i)
      slice.points.emplace_back(place(rng), kind % 3 == 0 ? std::round(place(rng)) : place(rng));
  }
  if (kind % 4 == 0) slice.field_of_view = {{-20, -22}, {25, -18}, {0, 27}};
  auto section = make_section(slice);
  REQUIRE(section);
  return *section;
}

struct Tally {
  int pixels = 0, known = 0, wrong = 0;
};

/// Every pixel against label_at(), unknown where it is not in the box.
Tally compare(const Section& section, const SectionRaster& raster) {
  Tally tally;
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      const Eigen::Vector2d p = raster.point(x, y);
      const Eigen::Vector3d at = section.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0);
      const bool frame = x == 0 || y == 0 || x == raster.width - 1 || y == raster.height - 1;
      const Label truth = kBox.contains(at) ? label_at(section, p) : kUnknown;
      ++tally.pixels;
      tally.known += raster.at(x, y) != kUnknown;
      tally.wrong += raster.at(x, y) != truth;
      if (frame) CHECK(raster.at(x, y) == kUnknown);
    }
  return tally;
}

}  // namespace

TEST_CASE("raster: every pixel has the label of its point") {
  std::mt19937 rng(1);
  Tally all;
  for (int i = 0; i < 60; ++i) {
    const Section section = tangle(rng, i);
    const Tally one = compare(section, rasterize(section, i % 3 == 0 ? 1.0 : 0.37, kBox));
    all.pixels += one.pixels;
    all.known += one.known;
    all.wrong += one.wrong;
  }
  MESSAGE("pixels: ", all.pixels, ", known: ", all.known);
  CHECK(all.known > 100000);
  CHECK(all.wrong == 0);
}

TEST_CASE("raster: the box decides what is kept, not where the points are") {
  std::mt19937 rng(2);
  const Section section = tangle(rng, 1);
  const SectionRaster whole = rasterize(section, 0.5, kBox);
  const SectionRaster part = rasterize(section, 0.5, {kBox.min() / 2, kBox.max() / 2});
  const Eigen::Vector2d shift = part.first - whole.first;
  int kept = 0, same = 0;
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) {
      if (part.at(x, y) == kUnknown) continue;
      ++kept;
      same += part.at(x, y) == whole.at(x + static_cast<int>(shift.x()), y + static_cast<int>(shift.y()));
    }
  CHECK(kept > 500);
  CHECK(same == kept);
}

TEST_CASE("raster: known area is what the pixels add up to") {
  Section section = test::section_of_discs(Eigen::Isometry3d::Identity(), {{{2, 3}, 10, 1}}, 300);
  test::bound_view(section);
  const SectionRaster raster = rasterize(section, 0.25, kBox);
  const auto known = std::count(raster.label.begin(), raster.label.end(), Label{1});
  CHECK(static_cast<double>(known) * 0.0625 == doctest::Approx(314.16).epsilon(0.005));
}

TEST_CASE("raster: nothing is stored of a slice that misses the box or knows nothing") {
  Section section;  // all outside
  section.image_to_reference.translation().z() = 50;
  CHECK(rasterize(section, 1, kBox).label.empty());
  section.image_to_reference.translation().z() = 0;
  CHECK(rasterize(section, 1, kBox).width == 68);  // 65 mm from pixel to pixel, and the rim
  section.border = kUnknown;
  CHECK(rasterize(section, 1, kBox).label.empty());
}
