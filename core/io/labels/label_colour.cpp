#include <algorithm>
#include <array>
#include <cmath>

#include "core/io/labels/label_table.h"

namespace sonoloft {

Rgb label_colour(Label label) {
  if (label == kOutside || label > kMaxLabel) return {128, 128, 128};
  // The few labels that most scans have, by hand: soft enough to be looked at, far apart also without green or red.
  constexpr std::array<Rgb, 5> kFirst = {
      {{205, 98, 80}, {72, 130, 190}, {235, 185, 75}, {98, 170, 110}, {150, 110, 185}}};
  if (label <= kFirst.size()) return kFirst[label - 1u];
  // 100 hues in far steps, in three lightnesses and two saturations: 300 colours before one comes again.
  constexpr double kLight[] = {1.0, 0.6, 0.8}, kGrey[] = {0.1, 0.45};
  const double hue = std::fmod(label * 0.29, 1.0) * 6, light = kLight[label % 3], grey = kGrey[label % 2];
  const auto channel = [&](double shift) {
    const double distance = std::abs(std::fmod(hue + shift, 6.0) - 3) - 1;
    return static_cast<std::uint8_t>(255 * light * (grey + (1 - grey) * std::clamp(distance, 0.0, 1.0)));
  };
  return {channel(0), channel(4), channel(2)};
}

}  // namespace sonoloft
