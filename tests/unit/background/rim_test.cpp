#include "core/background/rim.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "tests/support/view_slices.h"

using namespace sonoloft;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kSpacing_mm = 2;

float weight_at(const Rim& rim, const Vector3d& point, Label label) {
  PointWeights out;
  rim.weigh({&point, 1}, out);
  const auto it = std::find(out.labels.begin(), out.labels.end(), label);
  return it == out.labels.end() ? 0.0f : out.weight[static_cast<std::size_t>(it - out.labels.begin())];
}

/// A square of label 1 that fills the field of view, seen from a frame of its own.
TrackedSlice square(double half_width) {
  TrackedSlice slice;
  slice.image_to_reference = Eigen::Translation3d(12, -7, 30) * Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized());
  const double w = half_width;
  test::add_contour(slice, {{-w, -w}, {w, -w}, {w, w}, {-w, w}}, 1);
  slice.field_of_view = slice.points;
  return slice;
}

/// Of a border a -> b of weight 1, by the midpoint rule. `point` and ends in one frame.
double integral(const Vector3d& a, const Vector3d& b, const Vector3d& point) {
  constexpr int kParts = 20000;
  const Vector3d along = b - a;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) {
    const Vector3d to = a + along * ((i + 0.5) / kParts) - point;
    sum += to.cross(along).norm() / std::pow(to.norm(), 3) / kParts;  // |d phi| = |to x d to| / |to|^2
  }
  return sum;
}

}  // namespace

TEST_CASE("rim: a slice that shows its whole plane has none") {
  TrackedSlice slice;
  test::add_contour(slice, test::ring({0, 0}, 20, 24), 1);
  const Rim rim(test::checked_section(slice), kSpacing_mm);
  CHECK_FALSE(rim.reaches({0, 0, 0}, 100));
  PointWeights out;
  const Vector3d point(20, 0, 0);
  rim.weigh({&point, 1}, out);
  CHECK(out.labels.empty());
  CHECK(out.weight.empty());
}

TEST_CASE("rim: a border weighs what quadrature says, faded by the distance of its pieces' middles") {
  // One piece a side: 4 mm are two spacings.
  const TrackedSlice slice = square(2);
  const Rim rim(test::checked_section(slice), kSpacing_mm);
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-12, 12);
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3d local(uniform(rng), uniform(rng), 0.5 * uniform(rng));
    double expected = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector2d a = slice.points[k], b = slice.points[(k + 1) % 4];
      const Vector3d start(a.x(), a.y(), 0), end(b.x(), b.y(), 0);
      const double d = (0.5 * (start + end) - local).norm() / (8 * kSpacing_mm);
      const double fade = std::max(1 - std::pow(d, 4), 0.0);
      expected += kSpacing_mm * fade * fade * integral(start, end, local);
    }
    const double found = static_cast<double>(weight_at(rim, slice.image_to_reference * local, 1));
    worst = std::max(worst, std::abs(found - expected) / std::max(expected, 0.01));
  }
  MESSAGE("largest relative error: " << worst);
  CHECK(worst < 1e-4);
}

TEST_CASE("rim: on the border its label outweighs everything, beyond eight spacings nothing is weighed") {
  const TrackedSlice slice = square(30);
  const Rim rim(test::checked_section(slice), kSpacing_mm);
  for (const double along : {-29.0, -3.3, 0.0, 17.5})
    CHECK(weight_at(rim, slice.image_to_reference * Vector3d(along, 30, 0), 1) > 1e4f);
  const Vector3d far = slice.image_to_reference * Vector3d(0, 0, 16.1),
                 beside(slice.image_to_reference * Vector3d(47, 0, 0));
  CHECK(weight_at(rim, far, 1) == 0);
  CHECK(weight_at(rim, beside, 1) == 0);
  CHECK_FALSE(rim.reaches(slice.image_to_reference * Vector3d(0, 0, 40), 20));
  CHECK(rim.reaches(slice.image_to_reference * Vector3d(30, 0, 10), 1));
}

TEST_CASE("rim: around a shadow that known parts enclose it weighs twenty times as much as at the end of the view") {
  const Vector3d middle(0, 0, 1);
  TrackedSlice hole;
  test::add_contour(hole, test::ring({0, 0}, 5, 24), kUnknown);
  TrackedSlice view;
  view.field_of_view = test::ring({0, 0}, 5, 24);
  const float around = weight_at(Rim(test::checked_section(hole), kSpacing_mm), middle, kOutside);
  const float within = weight_at(Rim(test::checked_section(view), kSpacing_mm), middle, kOutside);
  CHECK(within > 0.5f);
  CHECK(around / within == doctest::Approx(20).epsilon(1e-5));
}

TEST_CASE("rim: a shadow that reaches the end of the view is not enclosed") {
  TrackedSlice slice = square(10);
  test::add_contour(slice, {{-3, 4}, {3, 4}, {3, 20}, {-3, 20}}, kUnknown);
  const Rim rim(test::checked_section(slice), kSpacing_mm);
  TrackedSlice inside = square(10);
  test::add_contour(inside, {{-3, 4}, {3, 4}, {3, 9}, {-3, 9}}, kUnknown);
  const Rim enclosed(test::checked_section(inside), kSpacing_mm);
  const Vector3d point = slice.image_to_reference * Vector3d(0, 5, 0);
  CHECK(weight_at(enclosed, point, 1) > 10 * weight_at(rim, point, 1));
}

TEST_CASE("rim: each label weighs by its own part of the border") {
  TrackedSlice slice = square(10);
  slice.field_of_view = {{-10, -20}, {10, -20}, {10, 10}, {-10, 10}};  // outside below the square
  const Rim rim(test::checked_section(slice), kSpacing_mm);
  const auto at = [&](double y, Label label) {
    return weight_at(rim, slice.image_to_reference * Vector3d(12, y, 0), label);
  };
  CHECK(at(0, 1) > 10 * at(0, kOutside));
  CHECK(at(-18, kOutside) > 10 * at(-18, 1));
  CHECK(at(-10, 1) == doctest::Approx(at(-10, kOutside)).epsilon(0.1));
}

TEST_CASE("rim: what a point gets does not depend on the points beside it") {
  const TrackedSlice slice = square(25);
  const Rim rim(test::checked_section(slice), kSpacing_mm);
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> uniform(-40, 40);
  std::vector<Vector3d> points;
  for (int i = 0; i < 101; ++i)
    points.push_back(slice.image_to_reference * Vector3d(uniform(rng), uniform(rng), 0.3 * uniform(rng)));
  PointWeights together;
  rim.weigh(points, together);
  int reached = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(weight_at(rim, points[i], 1) == together.weight[i]);
    reached += together.weight[i] > 0 ? 1 : 0;
  }
  CHECK(reached > 50);
  CHECK(reached < 101);
}
