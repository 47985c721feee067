#include <algorithm>
#include <cmath>

#include "core/io/mesh_files.h"

namespace sonoloft {

std::array<std::uint8_t, 3> label_colour(Label label) {
  if (label == kOutside || label > kMaxLabel) return {128, 128, 128};
  // Steps of the golden angle around the hues never come near an earlier hue for long; three lightnesses tell rounds.
  const double hue = std::fmod(label * 0.6180339887498949, 1.0) * 6, light = 1.0 - 0.2 * (label % 3), grey = 0.35;
  const auto channel = [&](double shift) {
    const double distance = std::abs(std::fmod(hue + shift, 6.0) - 3) - 1;
    return static_cast<std::uint8_t>(255 * light * (grey + (1 - grey) * std::clamp(distance, 0.0, 1.0)));
  };
  return {channel(0), channel(4), channel(2)};
}

}  // namespace sonoloft
