#include "tests/bench/methods/pelvis.h"

#include <cmath>

#include "tests/support/stacks/stack_slices.h"

namespace sonoloft::bench {
namespace {

constexpr int kSlices = 35;
constexpr double kHeight_mm = 347;

/// A band along an arc of an ellipse: angles from-to, counted from the front.
test::Loop2d wing(double from, double to, double thickness_mm) {
  constexpr int kCorners = 150;
  test::Loop2d loop;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < kCorners; ++i) {
      const double along = side == 0 ? i / (kCorners - 1.0) : 1 - i / (kCorners - 1.0);
      const double angle = from + (to - from) * along;
      const double half = 0.5 * thickness_mm * std::sqrt(1.05 - std::pow(2 * along - 1, 4)) * (side == 0 ? 1 : -1);
      loop.emplace_back((185 + half) * std::sin(angle), (125 + half) * std::cos(angle));
    }
  return loop;
}

}  // namespace

std::vector<TrackedSlice> pelvis() {
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < kSlices; ++i) {
    const double t = i / (kSlices - 1.0), height_mm = kHeight_mm * t, thickness_mm = 18 + 16 * std::sin(3 * t);
    if (std::abs(t - 0.5) < 0.12) {
      TrackedSlice ring =
          test::slice_at(height_mm, {test::ellipse({0, 0}, 185 + thickness_mm / 2, 125 + thickness_mm / 2, 300),
                                     test::ellipse({0, 0}, 185 - thickness_mm / 2, 125 - thickness_mm / 2, 300)});
      ring.contours[1].hole = true;
      slices.push_back(ring);
    } else {
      const double front = 0.25 + 0.9 * std::abs(t - 0.5), back = 3.0 - 0.5 * t;
      slices.push_back(test::slice_at(height_mm, {wing(front, back, thickness_mm), wing(-front, -back, thickness_mm)}));
    }
  }
  return slices;
}

}  // namespace sonoloft::bench
