#include "device_sim/probe/segmentation_mask.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace sonoloft::device_sim;
using sonoloft::protocol::Contour;
using sonoloft::protocol::kHoleFlag;
using sonoloft::protocol::kUnknownLabel;
using sonoloft::protocol::Point;
using sonoloft::protocol::WireLabel;

namespace {

struct Drawing {
  std::vector<Point> points;
  std::vector<Contour> contours;

  void circle(double x, double y, double radius, WireLabel label, std::uint16_t flags = 0) {
    constexpr int kPoints = 400;
    contours.push_back({static_cast<std::uint32_t>(points.size()), kPoints, label, flags});
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2 * std::numbers::pi * i / kPoints;
      points.push_back(
          {static_cast<float>(x + radius * std::cos(angle)), static_cast<float>(y + radius * std::sin(angle))});
    }
  }
};

// The label of every pixel, by its place in the image.
template <class Expected>
int wrong_pixels(const SegmentationMask& mask, const Expected& expected) {
  int at = 0, wrong = 0;
  for (const auto& run : mask.runs) {
    for (int i = 0; i < run.count; ++i, ++at) {
      const double x = mask.grid.x_px + mask.grid.step_px * static_cast<float>(at % mask.grid.width);
      const double y = mask.grid.y_px + mask.grid.step_px * static_cast<float>(at / mask.grid.width);
      wrong += expected(x, y) == run.label ? 0 : 1;
    }
  }
  CHECK(at == mask.grid.width * mask.grid.height);
  return wrong;
}

}  // namespace

TEST_CASE("segmentation mask: the smallest contour around a pixel says its label, whatever their order") {
  Drawing drawing;
  drawing.circle(300, 200, 20, 2);
  drawing.circle(300, 200, 120, 1);
  drawing.circle(300, 200, 60, 1, kHoleFlag);
  drawing.circle(420, 260, 30.5, kUnknownLabel);
  const std::vector<Point> view{{0, 0}, {640, 0}, {640, 480}, {0, 480}};
  for (const std::uint16_t pixels : {std::uint16_t{64}, std::uint16_t{512}}) {
    const auto mask = paint_mask(drawing.points, drawing.contours, view, pixels);
    CHECK(mask.grid.width == pixels);
    CHECK(mask.grid.height == pixels * 3 / 4);
    const int wrong = wrong_pixels(mask, [](double x, double y) -> WireLabel {
      if (std::hypot(x - 420, y - 260) < 30.5) return kUnknownLabel;
      const double r = std::hypot(x - 300, y - 200);
      if (r < 20) return 2;
      return r >= 60 && r < 120 ? 1 : 0;
    });
    CHECK(wrong <= pixels / 256);  // a polygon of 400 corners is no circle
  }
}

TEST_CASE("segmentation mask: without a field of view it lies around the contours and an eighth of them") {
  Drawing drawing;
  drawing.circle(50, 80, 40, 3);
  const auto mask = paint_mask(drawing.points, drawing.contours, {}, 100);
  CHECK(mask.grid.step_px == doctest::Approx(1));
  CHECK(mask.grid.x_px == doctest::Approx(50 - 50 + 0.5));
  CHECK(mask.grid.y_px == doctest::Approx(80 - 50 + 0.5));
  CHECK(mask.grid.width == 100);
  CHECK(mask.grid.height == 100);
}

TEST_CASE("segmentation mask: nothing at all is one pixel of outside") {
  const auto mask = paint_mask({}, {}, {}, 100);
  REQUIRE(mask.runs.size() == 1);
  CHECK(mask.runs[0].count == 1);
  CHECK(mask.runs[0].label == 0);
}
