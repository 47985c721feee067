#include "core/segmentation/bone_segmentation.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace sonoloft;

namespace {

constexpr int kWidth = 300, kHeight = 400;
constexpr double kPixel_mm = 0.1;

/// The row of an arc of bone; none beside columns 40..259.
double arc(int x) {
  return 200 + 0.006 * (x - 150) * (x - 150);
}

/// Speckle above, an arc of bone with a weak echo of its own below, fascia that shadows nothing.
GreyImage image(bool with_bone) {
  std::mt19937 random(7);
  GreyImage grey{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool bony = with_bone && x >= 40 && x < 260;
      const double depth = y - arc(x);
      double value = static_cast<double>(random() % 90);
      if (std::abs(y - 100) < 4) value = 180;
      if (bony && depth > 6) value = std::abs(depth - 90) < 10 ? 40 : static_cast<double>(random() % 20);
      if (bony && std::abs(depth) <= 6) value = 220;
      grey.pixels.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return grey;
}

Label at(const std::vector<Label>& labels, int x, double y) {
  return labels[static_cast<std::size_t>(static_cast<int>(y) * kWidth + x)];
}

}  // namespace

TEST_CASE("bone: the arc over a shadow is found, not the fascia above it; below all is unknown") {
  const auto labels = segment_bone(image(true), {kPixel_mm, kPixel_mm});
  REQUIRE(labels.size() == kWidth * kHeight);
  double farthest = 0;
  for (int x = 45; x < 255; ++x) {
    int surface = 0;
    while (surface < kHeight && at(labels, x, surface) == kOutside) ++surface;
    farthest = std::max(farthest, std::abs(surface - arc(x)));
    CHECK(at(labels, x, surface + 19) == kBone);
    CHECK(at(labels, x, surface + 20) == kUnknown);
    CHECK(at(labels, x, kHeight - 1) == kUnknown);
  }
  MESSAGE("the line is off by up to ", farthest, " pixels");
  CHECK(farthest < 8);
  for (const int x : {5, 295}) {
    CHECK(at(labels, x, 150) == kOutside);
    CHECK(at(labels, x, kHeight - 1) == kUnknown);
  }
}

TEST_CASE("bone: where nothing throws a shadow, nothing is said") {
  const auto says_nothing = [](const GreyImage& grey) {
    const auto labels = segment_bone(grey, {kPixel_mm, kPixel_mm});
    return std::ranges::all_of(labels, [](Label l) { return l == kUnknown; });
  };
  GreyImage speckle = image(false);
  for (std::uint8_t& value : speckle.pixels) value = static_cast<std::uint8_t>(value % 90);
  CHECK(says_nothing(speckle));
  CHECK(says_nothing({kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 0)}));
  CHECK(says_nothing({1, 1, {255}}));
}
