#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "core/slice/mask/label_mask.h"
#include "core/slice/section.h"

using namespace sonoloft;

namespace {

struct Painted {
  int width, height;
  std::vector<Label> labels;

  [[nodiscard]] LabelMask view() const { return {width, height, labels}; }
};

Painted paint(int width, int height, const std::function<Label(double x, double y)>& label) {
  Painted painted{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) painted.labels.push_back(label(x, y));
  }
  return painted;
}

Section section_of(MaskContours traced) {
  TrackedSlice slice;
  slice.points = std::move(traced.points);
  slice.contours = std::move(traced.contours);
  auto section = make_section(slice);
  REQUIRE(section);
  return *section;
}

double area_of(const MaskContours& traced, const Contour& contour) {
  double twice = 0;
  for (std::uint32_t i = 0; i < contour.count; ++i) {
    const auto& a = traced.points[contour.first + i];
    const auto& b = traced.points[contour.first + (i + 1) % contour.count];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return std::abs(twice) / 2;
}

}  // namespace

TEST_CASE("mask: an empty one has no contours, a full one the rectangle of its pixels") {
  CHECK(trace_mask(paint(7, 5, [](double, double) { return kOutside; }).view()).contours.empty());
  const auto full = trace_mask(paint(7, 5, [](double, double) { return Label{3}; }).view());
  REQUIRE(full.contours.size() == 1);
  CHECK(full.contours[0].count == 4);
  CHECK(full.contours[0].label == 3);
  CHECK(area_of(full, full.contours[0]) == doctest::Approx(35));
}

TEST_CASE("mask: the border of a disc is round again, to a fifth of a pixel") {
  for (const double radius : {3.0, 10.0, 37.5, 120.0}) {
    const double centre = radius + 4.3;
    const int size = static_cast<int>(2 * centre) + 2;
    const auto disc = paint(size, size, [&](double x, double y) {
      return std::hypot(x - centre, y - centre) < radius ? Label{1} : kOutside;
    });
    const auto traced = trace_mask(disc.view());
    REQUIRE(traced.contours.size() == 1);
    double worst = 0, sum2 = 0;
    for (const auto& p : traced.points) {
      const double off = std::abs((p - Eigen::Vector2d::Constant(centre)).norm() - radius);
      worst = std::max(worst, off);
      sum2 += off * off;
    }
    const double rms = std::sqrt(sum2 / static_cast<double>(traced.points.size()));
    const double area = area_of(traced, traced.contours[0]) / (std::numbers::pi * radius * radius);
    MESSAGE("radius " << radius << ": off by " << rms << " pixels rms, at most " << worst << "; area " << area << ", "
                      << traced.points.size() << " points");
    CHECK(rms < 0.2);    // of the staircase: 0.37
    CHECK(worst < 0.5);  // no mask says more
    CHECK(area == doctest::Approx(1).epsilon(0.7 / radius / radius + 0.004));
    CHECK(traced.points.size() < 4 * radius + 16);  // of the staircase: 8 radius
  }
}

TEST_CASE("mask: every pixel keeps its label, whatever the mask") {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const std::uint32_t labels = 2 + seed % 4;
    const int width = 1 + static_cast<int>(random() % 30), height = 1 + static_cast<int>(random() % 30);
    const auto coarse = 1 + static_cast<int>(seed % 3);  // squares of that many pixels
    std::vector<Label> of_square(1000);
    for (Label& label : of_square) {
      label = static_cast<Label>(random() % labels);
      if (label == 3) label = kUnknown;
    }
    const auto painted = paint(width, height, [&](double x, double y) {
      return of_square[static_cast<std::size_t>(static_cast<int>(x) / coarse * 31 + static_cast<int>(y) / coarse)];
    });
    const Section section = section_of(trace_mask(painted.view()));
    int wrong = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Label label = painted.labels[static_cast<std::size_t>(y * width + x)];
        wrong += label_at(section, {x, y}) == label ? 0 : 1;
      }
    }
    CHECK_MESSAGE(wrong == 0, "seed " << seed << ", " << width << " x " << height);
    CHECK(section.repaired_crossings == 0);
  }
}

TEST_CASE("mask: a ring around another label, with a hole of outside") {
  const auto traced = trace_mask(paint(41, 41, [](double x, double y) {
                                   const double r = std::hypot(x - 20, y - 20);
                                   if (r < 5) return kOutside;
                                   if (r < 10) return Label{2};
                                   return r < 17 ? Label{1} : kOutside;
                                 }).view());
  REQUIRE(traced.contours.size() == 3);
  CHECK(std::count_if(traced.contours.begin(), traced.contours.end(), [](const Contour& c) { return c.hole; }) == 1);
  const Section section = section_of(traced);
  CHECK(label_at(section, {20, 20}) == kOutside);
  CHECK(label_at(section, {20, 27}) == 2);
  CHECK(label_at(section, {20, 34}) == 1);
  CHECK(label_at(section, {1, 1}) == kOutside);
}

TEST_CASE("mask: regions that touch share their border, point by point") {
  const auto traced =
      trace_mask(paint(60, 40, [](double x, double y) { return x + 0.3 * y < 30 ? Label{1} : Label{2}; }).view());
  REQUIRE(traced.contours.size() == 2);
  const auto inner_points = [&](const Contour& contour) {
    std::vector<std::pair<double, double>> points;
    for (std::uint32_t i = 0; i < contour.count; ++i) {
      const auto& p = traced.points[contour.first + i];
      if (p.y() > -0.4 && p.y() < 39.4) points.emplace_back(p.x(), p.y());
    }
    std::sort(points.begin(), points.end());
    return points;
  };
  const auto a = inner_points(traced.contours[0]), b = inner_points(traced.contours[1]);
  CHECK(a.size() > 2);
  CHECK(a == b);
}
