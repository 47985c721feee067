#include "core/completion/corner_values.h"

#include <doctest/doctest.h>

#include "core/field/reference.h"
#include "tests/support/field/field_cells.h"

using namespace sonoloft;

namespace {

constexpr CellId kCell{0};

/// The walls of one cell, nothing known behind them.
std::vector<std::vector<SeenWall>> walls_of(const test::FieldCell& cell) {
  std::vector<std::vector<SeenWall>> walls(1);
  for (const CellFace& face : cell.faces()) walls[0].push_back({face, kNoCellBehind});
  return walls;
}

}  // namespace

TEST_CASE("completion: where all that is known is of one label, corners are of that label exactly") {
  const std::array<Label, 2> labels{7, kUnknown};
  const std::array<Label, 2> slots{0, 7};
  test::Random random(1);
  int known_corners = 0;
  for (int round = 0; round < 40; ++round) {
    const test::FieldCell cell(test::random_walls(random, 8, labels, 9, 10));
    const GroupKnowledge known(walls_of(cell), std::array{kCell}, slots, 1e-6);
    std::array<PointLanes, 2> shares;
    known.shares(PlaneId{0}, std::array{cell.random_point(random)}, shares);
    CHECK(shares[0][0] + shares[1][0] == 1);
    CHECK((shares[1][0] == 1 || shares[0][0] == 1));
    known_corners += shares[1][0] == 1;
  }
  CHECK(known_corners > 30);
}

TEST_CASE("completion: of one cell's known walls, a corner in it takes what the field does without unknown parts") {
  const std::array<Label, 4> labels{0, 1, 2, kUnknown};
  const std::array<Label, 3> slots{0, 1, 2};
  test::Random random(5);
  double worst = 0;
  for (int round = 0; round < 30; ++round) {
    const test::FieldCell cell(test::random_walls(random, 9, labels, 9, 10));
    const Eigen::Vector3d point = cell.random_point(random);
    const GroupKnowledge known(walls_of(cell), std::array{kCell}, slots, 1e-6);
    std::array<PointLanes, 3> shares;
    known.shares(PlaneId{99}, std::array{point}, shares);  // a plane that is none of the walls
    const ReferenceShares field = reference_shares(cell.faces(), point, 1e-6);
    const double measured = 1 - field.share(kUnknown);
    if (measured < 0.01) continue;
    for (std::size_t slot = 0; slot < slots.size(); ++slot)
      worst = std::max(worst, std::abs(shares[slot][0] - field.share(slots[slot]) / measured));
  }
  MESSAGE("largest difference: " << worst);
  CHECK(worst < 1e-9);
}

TEST_CASE("completion: in its own plane a corner sees the rim of what is known as an angle over the distance") {
  // A square hole of side 2 in one label, seen from its centre: four sides, each the integral of dphi / r = sqrt(2).
  FacePolygon polygon;
  test::add_loop(polygon, {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, 1, kBeyondFace);
  test::add_loop(polygon, {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, kUnknown, 1);
  // Far away, above it, a wall of label 2 that fills a half space: pi / h.
  FacePolygon far;
  test::add_loop(far, {{-1e6, -1e6}, {1e6, -1e6}, {1e6, 1e6}, {-1e6, 1e6}}, 2, kBeyondFace);
  const double h = 5;
  const Eigen::Isometry3d own = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d above(Eigen::Translation3d(0, 0, h));
  const std::vector<std::vector<SeenWall>> walls{{{{&own, PlaneId{6}, true, kBeyondFace, &polygon}, kNoCellBehind},
                                                  {{&above, PlaneId{7}, false, 2, &far}, kNoCellBehind}}};
  const std::array<Label, 3> slots{0, 1, 2};
  const GroupKnowledge known(walls, std::array{kCell}, slots, 1e-6);
  std::array<PointLanes, 3> shares;
  known.shares(PlaneId{6}, std::array{Eigen::Vector3d(0, 0, 0)}, shares);
  const double rim = 2 * 4 * std::numbers::sqrt2, wall = std::numbers::pi / h;  // lambda is 2
  CHECK(shares[1][0] == doctest::Approx(rim / (rim + wall)).epsilon(1e-9));
  CHECK(shares[2][0] == doctest::Approx(wall / (rim + wall)).epsilon(1e-9));
}
