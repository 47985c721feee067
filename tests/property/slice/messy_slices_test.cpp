#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/slice/section.h"
#include "tests/support/slice_truth.h"

using namespace sonoloft;
using namespace sonoloft::test;
using Eigen::Vector2d;

namespace {

constexpr Label kLabels[] = {1, 2, 3, 4, kOutside, kUnknown};

/// Polygons that cross themselves and each other, share points and whole stretches, repeat points and each other.
class MessySlice {
 public:
  explicit MessySlice(unsigned seed) : random_(seed) {
    for (int i = 0; i < 3 + static_cast<int>(seed % 6); ++i) {
      switch (random_() % 4) {
        case 0:
          add(star(random_() % 2 == 0));
          break;
        case 1:
          add(scribble());
          break;
        case 2:
          add(borrowed());
          break;
        default:
          add(box());
          break;
      }
    }
    if (seed % 3 == 0) slice.field_of_view = star(true);
    if (seed % 9 == 0) slice.field_of_view = scribble();
  }

  TrackedSlice slice;

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vector2d somewhere() { return {uniform(-50, 50), uniform(-50, 50)}; }

  void add(const std::vector<Vector2d>& loop) {
    slice.contours.push_back({static_cast<std::uint32_t>(slice.points.size()), static_cast<std::uint32_t>(loop.size()),
                              kLabels[random_() % std::size(kLabels)], random_() % 5 == 0});
    slice.points.insert(slice.points.end(), loop.begin(), loop.end());
  }

  std::vector<Vector2d> star(bool large) {
    const Vector2d middle = somewhere() * 0.4;
    const double size = large ? uniform(20, 45) : uniform(2, 15);
    std::vector<Vector2d> loop;
    const int corners = 5 + static_cast<int>(random_() % 20);
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      loop.push_back(middle + uniform(0.5, 1) * size * Vector2d(std::cos(angle), std::sin(angle)));
    }
    if (random_() % 2) std::reverse(loop.begin(), loop.end());
    return loop;
  }

  std::vector<Vector2d> scribble() {
    std::vector<Vector2d> loop(4 + random_() % 8);
    for (Vector2d& p : loop) p = somewhere();
    loop.insert(loop.begin() + 2, loop[1]);  // a zero-length edge
    loop.push_back(loop[2]);                 // a point visited twice
    return loop;
  }

  /// Corners on whole millimetres: collinear overlaps and T-junctions with other boxes.
  std::vector<Vector2d> box() {
    const double x = std::floor(uniform(-8, 4)) * 5, y = std::floor(uniform(-8, 4)) * 5;
    const double w = std::floor(uniform(1, 6)) * 5, h = std::floor(uniform(1, 6)) * 5;
    return {{x, y}, {x + w, y}, {x + w, y + h}, {x + w / 2, y + h}, {x, y + h}};
  }

  /// A stretch of a contour that is there already, closed by another way round.
  std::vector<Vector2d> borrowed() {
    if (slice.contours.empty()) return box();
    const Loop other = loop_of(slice, slice.contours[random_() % slice.contours.size()]);
    const std::size_t count = 2 + random_() % (other.size() - 1);
    std::vector<Vector2d> loop(other.begin(), other.begin() + static_cast<std::ptrdiff_t>(count));
    loop.push_back(somewhere());
    return loop;
  }

  std::mt19937 random_;
};

}  // namespace

TEST_CASE("section: of messy slices it has the label that the rule gives, at every point") {
  int points = 0, skipped = 0;
  std::uint32_t crossings = 0;
  for (unsigned seed = 0; seed < 240; ++seed) {
    const MessySlice messy(seed);
    const SliceTruth truth(messy.slice);
    const auto section = make_section(messy.slice);
    REQUIRE(section.has_value());
    crossings += section->repaired_crossings;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> coordinate(-55, 55);
    int wrong = 0;
    for (int k = 0; k < 500; ++k) {
      const Vector2d p(coordinate(random), coordinate(random));
      if (truth.distance_to_border(p) < 1e-6) {
        ++skipped;
        continue;
      }
      ++points;
      wrong += label_at(*section, p) != truth.label_at(p);
    }
    CHECK_MESSAGE(wrong == 0, "seed ", seed);
  }
  MESSAGE(points, " points agree, ", skipped, " were too near to a border; ", crossings, " crossings");
  CHECK(points > 119000);
  CHECK(crossings > 1000);
}

TEST_CASE("section: both sides of every edge of messy slices have the labels that the rule gives") {
  int sides = 0, too_short = 0;
  for (unsigned seed = 0; seed < 240; ++seed) {
    const MessySlice messy(seed);
    const SliceTruth truth(messy.slice);
    const auto section = make_section(messy.slice);
    REQUIRE(section.has_value());
    int wrong = 0;
    for (const SectionEdge& e : section->edges) {
      const Vector2d a = section->points[e.a], d = section->points[e.b] - a, middle = a + 0.5 * d;
      CHECK(e.left != e.right);
      const Vector2d to_left = 2e-6 * Vector2d(-d.y(), d.x()).normalized();
      if (truth.distance_to_border(middle + to_left) < 1e-6 || truth.distance_to_border(middle - to_left) < 1e-6) {
        ++too_short;
        continue;
      }
      wrong += truth.label_at(middle + to_left) != e.left;
      wrong += truth.label_at(middle - to_left) != e.right;
      sides += 2;
    }
    CHECK_MESSAGE(wrong == 0, "seed ", seed);
  }
  MESSAGE(sides, " sides agree; ", too_short, " edges were too near to another");
  CHECK(sides > 10000);
  CHECK(too_short < sides / 50);
}
