#pragma once
#include <cstdint>

namespace sonoloft {

/// Which field fills the cells.
enum class FieldMethod : std::uint8_t {
  step,    ///< the published one: contours as they are, the surface leaves every slice at a right angle
  smooth,  ///< contours displaced by slope and curvature as the distance to their slice grows: smooth across slices
};

}  // namespace sonoloft
