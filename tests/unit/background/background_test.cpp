#include "core/background/background.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/view_slices.h"

using namespace sonoloft;
using Eigen::Vector3d;

namespace {

const Eigen::AlignedBox3d kBox(Vector3d::Constant(-80), Vector3d::Constant(80));

float share_at(const Background& background, const Vector3d& point, Label label) {
  PointShares shares;
  background.shares(std::span(&point, 1), shares);
  const auto it = std::find(shares.labels.begin(), shares.labels.end(), label);
  return it == shares.labels.end() ? 0.0f : shares.share[static_cast<std::size_t>(it - shares.labels.begin())];
}

/// A plane z = height, label 1 wherever it is known: in a square of this half width.
Section square(double height, double half_width, Label label = 1) {
  TrackedSlice slice;
  slice.image_to_reference.translation().z() = height;
  const double w = half_width;
  test::add_contour(slice, {{-w, -w}, {w, -w}, {w, w}, {-w, w}}, label);
  slice.field_of_view = slice.points;
  return test::checked_section(slice);
}

}  // namespace

TEST_CASE("background: without slices everything is outside, and far") {
  const Background background(kBox, 4);
  const Vector3d point(1, 2, 3);
  PointShares shares;
  std::vector<float> weight, distance;
  background.shares(std::span(&point, 1), shares);
  CHECK(shares.labels == std::vector<Label>{kOutside});
  CHECK(shares.share == std::vector<float>{1});
  background.local(std::span(&point, 1), weight, shares);
  CHECK(weight == std::vector<float>{0});
  CHECK(shares.share == std::vector<float>{1});
  background.distance(std::span(&point, 1), distance);
  CHECK(distance == std::vector<float>{4.0f * kBackgroundReach});
  CHECK(background.seeds().empty());
  background.shares({}, shares);
  CHECK(shares.share.empty());
}

TEST_CASE("background: where all that was seen is one label, it has the largest share") {
  Background background(kBox, 4);
  for (double height = -30; height <= 30; height += 3) background.add(square(height, 30));
  background.update(1);
  float least = 1;
  for (int i = 0; i < 1000; ++i)
    least =
        std::min(least, share_at(background, {i % 10 * 5.0 - 22.5, i / 10 % 10 * 5.0 - 22.5, i / 100 * 5.0 - 22.5}, 1));
  MESSAGE("least share inside: ", least);
  CHECK(least > 0.998f);
  CHECK(share_at(background, {0, 0, 75}, 1) < 0.1f);
}

TEST_CASE("background: at a slice it says what the slice says, between slices it goes over smoothly") {
  Background background(kBox, 4);
  background.add(square(-8, 60, 1));
  background.add(square(8, 60, 2));
  background.update(1);
  CHECK(share_at(background, {3, 5, -8}, 1) > 0.95f);
  CHECK(share_at(background, {3, 5, 8}, 2) > 0.95f);
  float last = 1;
  for (double z = -8; z <= 8; z += 0.5) {
    const float share = share_at(background, {3, 5, z}, 1);
    CHECK(share <= last + 0.01f);
    last = share;
  }
  // Screened to both sides alike: halfway both labels have as much, and what is missing is outside.
  CHECK(share_at(background, {3, 5, 0}, 1) == doctest::Approx(share_at(background, {3, 5, 0}, 2)).epsilon(0.02));
}

TEST_CASE("background: far from a large plane the share falls as the screened equation says") {
  // A plane of label 1 all through the box: g = cosh-like between the plane and the box's wall, where it is 0.
  const double spacing = 2.5, lambda = 8 * spacing, wall = 80 + spacing / 2;
  Background background(kBox, spacing);
  background.add(square(0.625, 80));
  background.update(1);
  float worst = 0;
  for (double z = 5; z < 70; z += 1.25) {
    const double truth = std::sinh((wall - z) / lambda) / std::sinh(wall / lambda);
    const float share = share_at(background, {0, 0, z}, 1);
    worst = std::max(worst, std::abs(share - static_cast<float>(truth)));
  }
  MESSAGE("off by at most ", worst);
  CHECK(worst < 0.08f);
}

TEST_CASE("background: local() weighs one slice as 1 and knows labels before any update") {
  Background background(kBox, 4);
  background.add(square(2, 40));  // a layer of nodes
  const std::vector<Vector3d> points{{1, 3, 2}, {-7, 11, 4}, {5, 5, 30}};
  std::vector<float> weight;
  PointShares shares;
  background.local(points, weight, shares);
  CHECK(shares.labels == std::vector<Label>{0, 1});
  CHECK(weight[0] == doctest::Approx(1).epsilon(0.01));
  CHECK(weight[1] == doctest::Approx(0.5).epsilon(0.01));
  CHECK(weight[2] == 0);
  CHECK(std::vector<float>(shares.share.begin() + 3, shares.share.end()) == std::vector<float>{1, 1, 0});
}

TEST_CASE("background: its surfaces pass through its seeds") {
  Background background(kBox, 4);
  for (double height = -20; height <= 20; height += 4) background.add(square(height, 40));
  background.update(1);
  const auto seeds = background.seeds();
  std::size_t cells = 0;
  for (const BackgroundChange& brick : seeds) cells += brick.begun.count();
  MESSAGE("seeds: ", cells);
  // About the surface of a block of 20 x 20 x 10 cells.
  CHECK(cells > 1200);
  CHECK(cells < 3500);
  Vector3d point(0, 0, 0);
  while (share_at(background, point, 1) >= 0.5f) point.z() += 0.1;
  bool found = false;
  for (const BackgroundChange& brick : seeds)
    for (int bit = 0; bit < 512; ++bit)
      found = found || (brick.begun.test(static_cast<std::size_t>(bit)) &&
                        background.cell_box(brick.brick, bit).contains(point));
  CHECK(found);
}

TEST_CASE("background: a slice that misses the box, and one beyond all bounds, are taken as they are") {
  Background background(kBox, 4);
  background.add(square(500, 40));
  CHECK(background.update(1).empty());
  TrackedSlice all;  // the whole plane was seen: outside
  background.add(test::checked_section(all));
  background.update(1);
  const Vector3d point(20, 20, 0);
  std::vector<float> distance;
  background.distance(std::span(&point, 1), distance);
  CHECK(distance[0] < 4);
  CHECK(share_at(background, point, kOutside) == 1.0f);
}
