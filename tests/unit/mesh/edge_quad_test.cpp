#include "core/mesh/drawing/edge_quad.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

namespace sonoloft::test {
namespace {

using Corner = std::array<std::int32_t, 3>;

/// How far a point lies inside of the envelope of the edge: least of its distances, in steps, negative outside.
double depth_in_envelope(const EdgeQuad& quad, const Eigen::Vector3d& p) {
  double depth = -1e9;
  for (std::size_t i = 0; i < 4; ++i) {
    const Corner &c = quad[i], &d = quad[(i + 1) % 4];
    Eigen::Matrix2d wedge;
    wedge << c[0], d[0], c[1], d[1];
    const double det = wedge(0, 0) * wedge(1, 1) - wedge(0, 1) * wedge(1, 0);
    const double s = (p.x() * wedge(1, 1) - p.y() * wedge(0, 1)) / det;
    const double t = (p.y() * wedge(0, 0) - p.x() * wedge(1, 0)) / det;
    if (s < -1e-12 || t < -1e-12) continue;  // another of the four tetrahedra
    const double above = p.z() / kStep - (s * c[2] + t * d[2]) / kStep;
    depth = std::max(depth, std::min({1 - s - t, above, 1 - s - t - above}));
  }
  return depth;
}

/// The least depth of points all over the two triangles of a quad cut from corner `first`.
double least_depth(const EdgeQuad& quad, std::size_t first) {
  const auto at = [&](std::size_t i) {
    const Corner& c = quad[(first + i) % 4];
    return Eigen::Vector3d(c[0], c[1], c[2]);
  };
  constexpr int kGrid = 40;
  double least = 1;
  for (const std::size_t tip : {1u, 3u})
    for (int i = 0; i <= kGrid; ++i)
      for (int j = 0; i + j <= kGrid; ++j) {
        const double s = static_cast<double>(i) / kGrid, t = static_cast<double>(j) / kGrid;
        least = std::min(least, depth_in_envelope(quad, at(0) + s * (at(2) - at(0)) + t * (at(tip) - at(0))));
      }
  return least;
}

EdgeQuad random_quad(std::mt19937& random) {
  std::uniform_int_distribution<std::int32_t> inside(1966, 63570);
  EdgeQuad quad;
  for (std::size_t i = 0; i < 4; ++i)
    quad[i] = {inside(random) - (i == 1 || i == 2 ? kStep : 0), inside(random) - (i >= 2 ? kStep : 0), inside(random)};
  return quad;
}

TEST_CASE("mesh: a diagonal is called safe when, and only when, both triangles stay in the envelope of the edge") {
  std::mt19937 random(3);
  int with_diagonal = 0, without = 0;
  for (int round = 0; round < 1500; ++round) {
    const EdgeQuad quad = random_quad(random);
    const std::array<double, 2> depth = {least_depth(quad, 0), least_depth(quad, 1)};
    if (const auto diagonal = safe_diagonal(quad)) {
      CHECK(depth[static_cast<std::size_t>(*diagonal)] > -1e-9);
      ++with_diagonal;
    } else {  // a grid of points may just miss where the triangle leaves
      CHECK(depth[0] < 0.02);
      CHECK(depth[1] < 0.02);
      ++without;
    }
  }
  MESSAGE(with_diagonal, " quads with a safe diagonal, ", without, " without");
  CHECK(with_diagonal > 500);
  CHECK(without > 20);
}

TEST_CASE("mesh: a flat quad is cut along its shorter diagonal, also when that runs through the edge") {
  const std::int32_t n = 20000, f = 60000, w = kStep / 2;
  const EdgeQuad along02 = {Corner{n, n, w}, Corner{-f, f, w}, Corner{-n, -n, w}, Corner{f, -f, w}};
  const EdgeQuad along13 = {Corner{f, f, w}, Corner{-n, n, w}, Corner{-f, -f, w}, Corner{n, -n, w}};
  CHECK(safe_diagonal(along02) == 0);
  CHECK(safe_diagonal(along13) == 1);
}

TEST_CASE(
    "mesh: of two safe diagonals the one with the larger smallest angle is taken, in all four turns of the quad") {
  std::mt19937 random(4);
  int turned = 0;
  for (int round = 0; round < 300; ++round) {
    const EdgeQuad quad = random_quad(random);
    EdgeQuad other;  // a quarter turn about the edge
    for (std::size_t i = 0; i < 4; ++i) other[(i + 1) % 4] = {-quad[i][1], quad[i][0], quad[i][2]};
    const auto a = safe_diagonal(quad), b = safe_diagonal(other);
    REQUIRE(a.has_value() == b.has_value());
    if (a) CHECK(*a == 1 - *b);
    turned += a.has_value();
  }
  CHECK(turned > 100);
}

}  // namespace
}  // namespace sonoloft::test
