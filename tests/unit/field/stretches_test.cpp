#include "core/field/packing/stretches.h"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

using namespace sonoloft;
using kernels::PackedStretch;
using kernels::PackedVertex;

namespace {

/// An arc around the origin that moves outward.
std::vector<PackedVertex> arc(int edges, double radius, double angle) {
  std::vector<PackedVertex> chain;
  for (int i = 0; i <= edges; ++i) {
    const double at = angle * i / edges;
    const float x = static_cast<float>(std::cos(at)), y = static_cast<float>(std::sin(at));
    const float r = static_cast<float>(radius);
    chain.push_back({r * x, r * y, x, y, 0.5f, 1 / r, 2 / r});
  }
  return chain;
}

Eigen::Vector2d moved(const PackedVertex& v, double by) {
  return Eigen::Vector2d(v.x, v.y) + by * Eigen::Vector2d(v.outward_x, v.outward_y);
}

/// Between the origin and the path.
double area(const std::vector<PackedVertex>& path, double by) {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d a = moved(path[i - 1], by), b = moved(path[i], by);
    sum += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return sum;
}

std::vector<PackedStretch> stretches_of(const std::vector<PackedVertex>& chain) {
  std::vector<PackedStretch> stretches;
  add_stretches(chain, 0, stretches);
  return stretches;
}

}  // namespace

TEST_CASE("stretches: short chains have none, long ones halves of halves that leave no edge out") {
  CHECK(stretches_of(arc(15, 1, 1)).empty());
  const std::vector<PackedStretch> all = stretches_of(arc(1000, 1, 6));
  REQUIRE(all.size() > 100);
  CHECK(all.front().count == 1000);
  CHECK(all.front().next == all.size());
  std::uint32_t edge = 0;
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    CHECK(all[i].first == edge);
    if (all[i].next == i + 1) {
      edge += all[i].count;
      continue;
    }
    const PackedStretch &half = all[i + 1], &other = all[half.next];
    CHECK(half.count + other.count == all[i].count);
    CHECK(other.next == all[i].next);
  }
  CHECK(edge == 1000);
}

TEST_CASE("stretches: the two edges enclose the area of the arc, also once it has moved outward") {
  const std::vector<PackedVertex> chain = arc(100, 0.3, 0.8);
  const PackedStretch whole = stretches_of(chain).front();
  const std::vector<PackedVertex> two{chain.front(), whole.middle, chain.back()};
  CHECK(area(two, 0) == doctest::Approx(area(chain, 0)).epsilon(1e-6));
  const double growth = area(chain, 0.01) - area(chain, 0);
  CHECK(growth > 0.002);
  CHECK(area(two, 0.01) - area(two, 0) == doctest::Approx(growth).epsilon(1e-3));
  CHECK(whole.middle.slope == doctest::Approx(0.5).epsilon(1e-4));
  CHECK(whole.middle.curvature == doctest::Approx(1 / 0.3).epsilon(1e-4));
}

TEST_CASE("stretches: one that turns back on itself never stands for its edges, one of a straight line soon does") {
  CHECK(std::isinf(stretches_of(arc(100, 0.3, 5)).front().least2));
  std::vector<PackedVertex> line;
  for (int i = 0; i <= 100; ++i) line.push_back({0.01f * static_cast<float>(i), 0, 0, 1, 0.2f, 0, 1});
  const PackedStretch whole = stretches_of(line).front();
  CHECK(whole.least2 == doctest::Approx(1).epsilon(1e-4));  // two radii
  CHECK(whole.rest < 1e-6f);
  CHECK(whole.sway < 1e-6f);
}

TEST_CASE("stretches: the rougher the slopes along one, the farther away it is told apart") {
  std::vector<PackedVertex> even = arc(64, 1, 0.5), rough = even;
  for (std::size_t i = 0; i < rough.size(); ++i) rough[i].slope += i % 2 == 0 ? 0.3f : -0.3f;
  CHECK(stretches_of(rough).front().sway > 10 * stretches_of(even).front().sway);
}
