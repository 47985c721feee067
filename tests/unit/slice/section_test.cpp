#include "core/slice/section.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/slice_truth.h"

using namespace sonoloft;
using Eigen::Vector2d;

namespace {

using Points = std::vector<Vector2d>;

void add(TrackedSlice& slice, const Points& loop, Label label, bool hole = false) {
  slice.contours.push_back(
      {static_cast<std::uint32_t>(slice.points.size()), static_cast<std::uint32_t>(loop.size()), label, hole});
  slice.points.insert(slice.points.end(), loop.begin(), loop.end());
}

Points box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Section section_of(const TrackedSlice& slice) {
  auto section = make_section(slice);
  REQUIRE(section.has_value());
  return *section;
}

/// Area of a label, from the edges alone: their two sides must fit all around for this to come out right.
double area(const Section& section, Label label) {
  double sum = 0;
  for (const SectionEdge& e : section.edges) {
    const Vector2d &a = section.points[e.a], &b = section.points[e.b];
    sum += 0.5 * ((e.left == label) - (e.right == label)) * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

}  // namespace

TEST_CASE("section: regions nest, whatever their order and direction") {
  Points small = box(4, 4, 6, 6);
  std::reverse(small.begin(), small.end());
  TrackedSlice slice;
  add(slice, small, 3);
  add(slice, box(0, 0, 10, 10), 1);
  add(slice, box(2, 2, 8, 8), 2);
  const Section section = section_of(slice);
  CHECK(label_at(section, {5, 5}) == 3);
  CHECK(label_at(section, {3, 5}) == 2);
  CHECK(label_at(section, {1, 5}) == 1);
  CHECK(label_at(section, {-1, 5}) == kOutside);
  CHECK(area(section, 1) == doctest::Approx(64));
  CHECK(area(section, 2) == doctest::Approx(32));
  CHECK(area(section, 3) == doctest::Approx(4));
  CHECK(section.edges.size() == 12);
  CHECK(section.repaired_crossings == 0);
  CHECK(section.border == kOutside);
}

TEST_CASE("section: a hole is outside, an island in it is not, and what fills it exactly wins") {
  TrackedSlice slice;
  add(slice, box(0, 0, 10, 10), 1);
  add(slice, box(2, 2, 8, 8), 1, true);
  add(slice, box(4, 4, 6, 6), 2);
  const Section section = section_of(slice);
  CHECK(label_at(section, {1, 1}) == 1);
  CHECK(label_at(section, {3, 3}) == kOutside);
  CHECK(label_at(section, {5, 5}) == 2);
  CHECK(area(section, 1) == doctest::Approx(64));

  add(slice, {{8, 2}, {8, 8}, {2, 8}, {2, 2}}, 3);  // another start, another direction
  const Section filled = section_of(slice);
  CHECK(label_at(filled, {3, 3}) == 3);
  CHECK(label_at(filled, {5, 5}) == 2);
  CHECK(area(filled, 3) == doctest::Approx(32));
}

TEST_CASE("section: a shared border becomes one edge between two labels, also where only a part is shared") {
  TrackedSlice slice;
  add(slice, box(0, 0, 4, 10), 1);
  add(slice, box(4, 2, 8, 6), 2);  // overlaps the border x = 4 from 2 to 6
  const Section section = section_of(slice);
  const auto between = std::count_if(section.edges.begin(), section.edges.end(), [](const SectionEdge& e) {
    return std::min(e.left, e.right) == 1 && std::max(e.left, e.right) == 2;
  });
  CHECK(between == 1);
  CHECK(section.points.size() == 8);
  CHECK(section.edges.size() == 9);
  CHECK(area(section, 1) == doctest::Approx(40));
  CHECK(area(section, 2) == doctest::Approx(16));
}

TEST_CASE("section: borders that should coincide and do not leave slivers of at most their own distance") {
  TrackedSlice slice;
  add(slice, box(0, 0, 4, 10), 1);
  add(slice, {{4.001, 0}, {8, 0}, {8, 10}, {3.999, 10}}, 2);  // crosses x = 4 once
  const Section section = section_of(slice);
  CHECK(section.repaired_crossings == 1);
  CHECK(label_at(section, {4.0001, 1}) == kOutside);
  CHECK(label_at(section, {3.9999, 9}) == 1);  // both enclose it, of areas 40 and 39.99...
  CHECK(area(section, 1) + area(section, 2) == doctest::Approx(80).epsilon(1e-4));
}

TEST_CASE("section: a contour that crosses itself encloses by even-odd, with its even-odd area") {
  TrackedSlice slice;
  add(slice, {{0, 0}, {4, 4}, {4, 0}, {0, 4}}, 2);  // a bow-tie whose signed area is 0 and whose area is 8
  add(slice, {{0.5, 1.5}, {1, 1.5}, {1, 2.5}, {0.5, 2.5}}, 3);
  add(slice, box(-1, -1, 5, 5), 1);
  const Section section = section_of(slice);
  CHECK(section.repaired_crossings == 1);
  CHECK(label_at(section, {0.2, 2}) == 2);
  CHECK(label_at(section, {0.75, 2}) == 3);
  CHECK(label_at(section, {2, 3.5}) == 1);
  CHECK(area(section, 2) == doctest::Approx(7.5));
  CHECK(area(section, 3) == doctest::Approx(0.5));
  CHECK(area(section, 1) == doctest::Approx(28));
}

TEST_CASE("section: what a contour goes over twice does not bound it") {
  TrackedSlice slice;
  add(slice, {{0, 0}, {4, 0}, {4, 4}, {6, 4}, {4, 4}, {0, 4}}, 1);  // a spike out and back
  add(slice, {{10, 0}, {10, 0}, {12, 0}, {12, 2}, {12, 2}}, 2);     // edges of no length
  add(slice, {{20, 0}, {22, 0}, {21, 0}}, 3);                       // no area at all
  const Section section = section_of(slice);
  CHECK(section.edges.size() == 4 + 3);
  CHECK(area(section, 1) == doctest::Approx(16));
  CHECK(area(section, 2) == doctest::Approx(2));
}

TEST_CASE("section: equal contours are decided by the first, and a hole only where nothing else is") {
  TrackedSlice slice;
  add(slice, box(0, 0, 2, 2), 1, true);
  add(slice, box(0, 0, 2, 2), 2);
  add(slice, box(0, 0, 2, 2), 3);
  const Section section = section_of(slice);
  CHECK(label_at(section, {1, 1}) == 2);
  CHECK(section.edges.size() == 4);
  CHECK(section.repaired_crossings == 0);
}

TEST_CASE("section: contours that touch in a point share it and do not count as crossing") {
  TrackedSlice slice;
  add(slice, box(0, 0, 2, 2), 1);
  add(slice, box(2, 2, 4, 4), 2);
  add(slice, {{2, 1}, {4, 0}, {4, 1.5}}, 3);  // touches the first one's side with a corner
  const Section section = section_of(slice);
  CHECK(section.repaired_crossings == 0);
  CHECK(section.points.size() == 4 + 3 + 3);
  CHECK(section.edges.size() == 5 + 4 + 3);
}

TEST_CASE("section: outside of the field of view all is unknown, contours that reach over its rim are cut") {
  TrackedSlice slice;
  add(slice, box(-10, 2, 10, 4), 1);
  slice.field_of_view = box(0, 0, 5, 5);
  const Section section = section_of(slice);
  CHECK(section.border == kUnknown);
  CHECK(label_at(section, {2, 3}) == 1);
  CHECK(label_at(section, {2, 1}) == kOutside);
  CHECK(label_at(section, {-5, 3}) == kUnknown);
  CHECK(label_at(section, {50, 50}) == kUnknown);
  CHECK(area(section, 1) == doctest::Approx(10));
  CHECK(section.repaired_crossings == 0);
  CHECK(section.points.size() == 8);  // nothing is left of the contour outside
}

TEST_CASE("section: a view without contours has its rim, a slice without anything has nothing") {
  TrackedSlice slice;
  CHECK(section_of(slice).edges.empty());
  CHECK(label_at(section_of(slice), {0, 0}) == kOutside);
  slice.field_of_view = box(0, 0, 5, 5);
  const Section section = section_of(slice);
  CHECK(section.edges.size() == 4);
  CHECK(label_at(section, {1, 1}) == kOutside);
  CHECK(label_at(section, {6, 1}) == kUnknown);
}

TEST_CASE("section: a shadow is a region like any other: unknown, and labels within it are known") {
  TrackedSlice slice;
  add(slice, box(0, 0, 10, 10), 1);
  add(slice, box(5, -2, 7, 12), kUnknown);
  add(slice, box(5.5, 4, 6.5, 5), 2);
  const Section section = section_of(slice);
  CHECK(label_at(section, {1, 5}) == 1);
  CHECK(label_at(section, {6, 8}) == kUnknown);
  CHECK(label_at(section, {6, 11}) == kUnknown);
  CHECK(label_at(section, {6, 4.5}) == 2);
  CHECK(section.repaired_crossings == 4);
  CHECK(section.border == kOutside);
}

TEST_CASE("section: two thousand nested and a thousand crossing contours keep their areas") {
  TrackedSlice slice;
  for (int k = 0; k < 2000; ++k)
    add(slice, box(-2000 + k, -2000 + k, 2000 - k, 2000 - k), static_cast<Label>(1 + k % 2));
  const Section nested = section_of(slice);
  CHECK(nested.edges.size() == 8000);
  CHECK(area(nested, 1) == doctest::Approx(8004000));
  CHECK(area(nested, 2) == doctest::Approx(7996000));

  TrackedSlice chain;
  for (int k = 0; k < 1000; ++k) add(chain, box(3 * k, k % 2, 3 * k + 4, 10 + k % 2), static_cast<Label>(1 + k % 7));
  const Section crossed = section_of(chain);
  double total = 0;
  for (Label label = 1; label <= 7; ++label) total += area(crossed, label);
  CHECK(total == doctest::Approx(1000 * 40.0 - 999 * 9.0));
  CHECK(crossed.repaired_crossings == 2 * 999);
}

TEST_CASE("section: far from the image's origin and at any size it finds the same") {
  for (const double scale : {1e-9, 1.0, 1e5})
    for (const double offset : {0.0, 1e3, -1e8}) {
      if (scale < 1e-3 && offset != 0) continue;  // smaller than the last bit of its coordinates
      TrackedSlice slice;
      for (Points loop : {box(0, 0, 4, 10), box(4, 2, 8, 6), box(3, 3, 5, 4)}) {
        for (Vector2d& p : loop) p = p * scale + Vector2d(offset, -offset);
        add(slice, loop, static_cast<Label>(slice.contours.size() + 1));
      }
      const Section section = section_of(slice);
      CHECK(section.edges.size() == 16);
      CHECK(section.repaired_crossings == 2);
    }
}

TEST_CASE("section: every start and direction of a contour gives the same section") {
  TrackedSlice slice;
  Points wave;
  for (int k = 0; k < 60; ++k) {
    const double angle = 2 * std::numbers::pi * k / 60;
    wave.push_back((3 + 2 * std::sin(11 * angle)) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  add(slice, box(-2, -2, 2, 2), 1);
  add(slice, wave, 2);
  const Section first = section_of(slice);
  for (int turn = 1; turn < 60; turn += 7) {
    std::rotate(wave.begin(), wave.begin() + turn, wave.end());
    std::reverse(wave.begin(), wave.end());
    std::copy(wave.begin(), wave.end(), slice.points.begin() + 4);
    const Section again = section_of(slice);
    CHECK(again.points == first.points);
    CHECK(std::equal(again.edges.begin(), again.edges.end(), first.edges.begin(), first.edges.end(),
                     [](const SectionEdge& e, const SectionEdge& f) {
                       return e.a == f.a && e.b == f.b && e.left == f.left && e.right == f.right;
                     }));
  }
}
