#include "core/completion/plane_regions.h"

#include <doctest/doctest.h>

#include "core/completion/plane_lattice.h"
#include "tests/support/field/field_cells.h"
#include "tests/support/field/region_quadrature.h"

using namespace sonoloft;

namespace {

constexpr std::uint32_t kSlots = 3;

/// Unknown parts of a random wall, cut into triangles with linear shares.
struct Patch {
  test::Wall wall;
  PlaneLattice lattice;
  struct Part {
    UnknownPiece piece;
    std::array<LinearShare, kSlots> share;
  };
  std::vector<Part> parts;

  explicit Patch(test::Random& random) {
    const std::array<Label, 3> labels{0, 1, kUnknown};
    FacePolygon polygon = test::random_rings(random, labels, 9, 10);
    wall = test::random_wall(random, test::uniform_direction(random), 5, std::move(polygon));
    lattice = {graded_lines(-5, 4, -90, 90, 3), graded_lines(-3, 6, -90, 90, 4)};
    for (UnknownPiece& piece : unknown_pieces(lattice, wall.polygon)) {
      Part part{std::move(piece), {}};
      for (LinearShare& share : part.share)
        share = {test::uniform(random, 0, 1), {test::uniform(random, -0.02, 0.02), test::uniform(random, -0.02, 0.02)}};
      parts.push_back(std::move(part));
    }
  }

  [[nodiscard]] PlaneRegions regions() const {
    PlaneRegions regions(wall.frame, 1e-9);
    for (const Part& part : parts)
      for (std::uint32_t slot = 0; slot < kSlots; ++slot)
        for (const auto& [a, b] : part.piece.border) regions.add(a, b, slot, part.share[slot]);
    regions.finish();
    return regions;
  }
};

std::array<PointLanes, kSlots> weigh(const PlaneRegions& regions, const std::vector<Eigen::Vector3d>& points) {
  std::array<PointLanes, kSlots> sums{};
  regions.weigh(PointBlock(points, 0), sums);
  return sums;
}

}  // namespace

TEST_CASE("completion: the pieces of the triangles cover the unknown part of a wall") {
  test::Random random(2);
  int pieces = 0;
  for (int round = 0; round < 50; ++round) {
    const Patch patch(random);
    double area_mm2 = 0;
    for (const Patch::Part& part : patch.parts)
      for (const auto& [a, b] : part.piece.border) area_mm2 += 0.5 * (a.x() * b.y() - a.y() * b.x());
    CHECK(area_mm2 == doctest::Approx(area(patch.wall.polygon, kUnknown)).epsilon(1e-9));
    for (const Patch::Part& part : patch.parts) {
      Eigen::AlignedBox2d triangle;
      for (const std::uint32_t node : part.piece.nodes) triangle.extend(patch.lattice.point(node));
      for (const auto& [a, b] : part.piece.border) CHECK(triangle.squaredExteriorDistance(a) < 1e-18);
    }
    pieces += static_cast<int>(patch.parts.size());
  }
  MESSAGE(pieces << " pieces");
  CHECK(pieces > 1000);
}

TEST_CASE("completion: what linear patches weigh is their integral to 1e-8 of the whole") {
  test::Random random(3);
  double worst = 0;
  for (int round = 0; round < 12; ++round) {
    const Patch patch(random);
    const PlaneRegions regions = patch.regions();
    const double height = std::pow(10.0, test::uniform(random, -2, 1.5));
    const Eigen::Vector2d foot(test::uniform(random, -12, 12), test::uniform(random, -12, 12));
    const Eigen::Vector3d point = patch.wall.frame * Eigen::Vector3d(foot.x(), foot.y(), round % 2 ? height : -height);
    const auto sums = weigh(regions, {point});
    double whole = 0;
    for (const FaceEdge& e : patch.wall.polygon)
      if (e.right == kBeyondFace)
        whole += test::triangle_integral(e.a, e.b, foot, height, [](const Eigen::Vector2d&) { return 1.0; });
    for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
      double expected = 0;
      for (const Patch::Part& part : patch.parts) {
        const auto value = [&](const Eigen::Vector2d& y) {
          return part.share[slot].value + part.share[slot].gradient.dot(y);
        };
        for (const auto& [a, b] : part.piece.border) expected += test::triangle_integral(a, b, foot, height, value);
      }
      worst = std::max(worst, std::abs(sums[slot][0] - expected) / whole);
    }
  }
  MESSAGE("largest difference from quadrature: " << worst << " of the whole wall's weight");
  CHECK(worst < 1e-8);
}

TEST_CASE("completion: what a point is weighed with does not depend on the points beside it") {
  test::Random random(4);
  const PlaneRegions regions = Patch(random).regions();
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < kPointLanes; ++i)
    points.push_back(test::uniform(random, 0.1, 30) * test::uniform_direction(random));
  const auto together = weigh(regions, points);
  for (std::size_t i = 0; i < kPointLanes; ++i) {
    const auto alone = weigh(regions, {points[i]});
    for (std::uint32_t slot = 0; slot < kSlots; ++slot) CHECK(alone[slot][0] == together[slot][i]);
  }
}
