#pragma once
#include <algorithm>

namespace sonoloft {

/// How a front's way between two slices is spread over the height between them: share of the way over share of the
/// height, both 0..1, a cubic with the given slopes at both ends. Monotone for slopes 0..3.
/// Source: Fritsch, Carlson 1980.
struct Passage {
  float at_start = 1, at_end = 1;

  [[nodiscard]] float way(float t) const {
    return t * (at_start + t * (3 - 2 * at_start - at_end + t * (at_start + at_end - 2)));
  }
  [[nodiscard]] float slope(float t) const {
    return at_start + t * (2 * (3 - 2 * at_start - at_end) + t * 3 * (at_start + at_end - 2));
  }
};

/// The slope of a passage at one of its ends, for a front that runs there with a speed. @param most  largest slope
inline float passage_slope(float speed, float height_mm, float change_mm, float most) {
  return change_mm == 0 ? 1.0F : std::clamp(speed * height_mm / change_mm, 0.0F, most);
}

/// How fast a front runs through a slice: the weighted harmonic mean of its mean speeds below and above, 0 where it
/// turns. At most 3 times the slower of them. Source: Fritsch, Butland 1984.
inline float speed_through(float below, float above, float height_below, float height_above) {
  if (below * above <= 0) return 0;
  const float w = 2 * height_above + height_below, v = height_above + 2 * height_below;
  return (w + v) / (w / below + v / above);
}

}  // namespace sonoloft
