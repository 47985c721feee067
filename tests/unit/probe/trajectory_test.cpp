#include "device_sim/probe/trajectory.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

const Eigen::AlignedBox3d kBox(Eigen::Vector3d(-30, 100, 20), Eigen::Vector3d(170, 190, 140));

Eigen::Vector3d normal(const Eigen::Isometry3d& pose) {
  return pose.linear().col(2);
}

/// How far the worst point of the box is from its nearest plane.
double widest_gap(const Trajectory& trajectory) {
  Random random(5);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d p = test::random_point(kBox, random);
    double nearest = 1e9;
    for (const Eigen::Isometry3d& pose : trajectory)
      nearest = std::min(nearest, std::abs(normal(pose).dot(p - pose.translation())));
    worst = std::max(worst, nearest);
  }
  return worst;
}

bool all_rigid(const Trajectory& trajectory) {
  return std::all_of(trajectory.begin(), trajectory.end(), [](const Eigen::Isometry3d& pose) {
    const Eigen::Matrix3d& r = pose.linear();
    return (r * r.transpose()).isIdentity(1e-12) && r.determinant() > 0;
  });
}

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::min(1.0, std::abs(a.dot(b)))) * 180 / std::numbers::pi;
}

}  // namespace

TEST_CASE("trajectories: every sweep has its number of slices, looks at the box and leaves no wide gap") {
  const SweepOptions options{.slices = 60, .standoff_mm = {}};
  const struct {
    std::string name;
    Trajectory trajectory;
    double gap_mm;
  } cases[] = {{"linear", linear_sweep(kBox, options), 200.0 / 60 / 2 + 1e-9},
               {"fan", fan_sweep(kBox, options), 8},
               {"rotation", rotation_sweep(kBox, options), 4},
               {"freehand", freehand_sweep(kBox, options, Hand{}), 20}};
  for (const auto& c : cases) {
    const std::string& name = c.name;
    const Trajectory& trajectory = c.trajectory;
    INFO(name);
    CHECK(trajectory.size() == 60);
    CHECK(all_rigid(trajectory));
    const double gap = widest_gap(trajectory);
    MESSAGE(name << ": no point of the box is farther than " << gap << " mm from a plane");
    CHECK(gap <= c.gap_mm);
    for (const Eigen::Isometry3d& pose : trajectory) {
      const auto corners = box_section(kBox, pose);
      CHECK(!corners.empty());
      for (const Eigen::Vector2d& corner : corners) CHECK(corner.y() > 0);
    }
  }
}

TEST_CASE("trajectories: planes of a fan meet in a line, of a rotation in the probe's axis") {
  const SweepOptions options{.slices = 31, .standoff_mm = 12};
  const Trajectory fan = fan_sweep(kBox, options), rotation = rotation_sweep(kBox, options);
  for (std::size_t i = 0; i < 31; ++i) {
    CHECK((fan[i].translation() - fan[0].translation()).norm() < 1e-9);
    CHECK(std::abs(normal(fan[i]).dot(fan[0].linear().col(0))) < 1e-12);
    CHECK((rotation[i].linear().col(1) - rotation[0].linear().col(1)).norm() < 1e-12);
  }
  CHECK(degrees_between(normal(rotation[0]), normal(rotation[15])) == doctest::Approx(15 * 180.0 / 31));
  // The face stands 12 mm above the box, on the side of its shortest edge.
  CHECK(fan[0].translation().y() == doctest::Approx(100 - 12));
}

TEST_CASE("trajectories: a freehand sweep has planes of really different directions") {
  const Trajectory trajectory = freehand_sweep(kBox, {.slices = 90, .standoff_mm = {}}, Hand{});
  double widest = 0;
  for (const Eigen::Isometry3d& a : trajectory)
    for (const Eigen::Isometry3d& b : trajectory) widest = std::max(widest, degrees_between(normal(a), normal(b)));
  CHECK(widest > 85);
  // Within a stroke the hand moves smoothly: no jump between neighbours but between the three strokes.
  int jumps = 0;
  for (std::size_t i = 1; i < 90; ++i) jumps += degrees_between(normal(trajectory[i - 1]), normal(trajectory[i])) > 30;
  CHECK(jumps == 2);
}

TEST_CASE("trajectories: tremor has the asked spread and correlation") {
  const Hand hand{
      .passes = 1, .tilt_deg = 0, .tremor_deg = 1.5, .tremor_mm = 0.15, .tremor_correlation = 0.9, .seed = 9};
  constexpr std::uint32_t kSlices = 20'000;
  const Trajectory still = freehand_sweep(
      kBox, {.slices = kSlices, .standoff_mm = {}},
      {.passes = 1, .tilt_deg = 0, .tremor_deg = 0, .tremor_mm = 0, .tremor_correlation = 0.9, .seed = 9});
  const Trajectory shaken = freehand_sweep(kBox, {.slices = kSlices, .standoff_mm = {}}, hand);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero(), products = squares, last = squares;
  for (std::size_t i = 0; i < kSlices; ++i) {
    const Eigen::AngleAxisd turn(still[i].linear().transpose() * shaken[i].linear());
    const Eigen::Vector3d degrees = turn.angle() * turn.axis() * 180 / std::numbers::pi;
    squares += degrees.cwiseAbs2();
    products += degrees.cwiseProduct(last);
    last = degrees;
  }
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(std::sqrt(squares[axis] / kSlices) == doctest::Approx(1.5).epsilon(0.1));
    CHECK(products[axis] / squares[axis] == doctest::Approx(0.9).epsilon(0.02));
  }
}

TEST_CASE("trajectories: the same seed is the same hand, another seed another") {
  const SweepOptions options{.slices = 20, .standoff_mm = {}};
  Hand hand;
  const Trajectory one = freehand_sweep(kBox, options, hand), again = freehand_sweep(kBox, options, hand);
  hand.seed = 2;
  const Trajectory other = freehand_sweep(kBox, options, hand);
  for (std::size_t i = 0; i < 20; ++i) {
    CHECK(one[i].matrix() == again[i].matrix());
    CHECK(one[i].matrix() != other[i].matrix());
  }
  CHECK(freehand_sweep(kBox, {.slices = 2, .standoff_mm = {}}, {.passes = 5}).size() == 2);
  CHECK(freehand_sweep(kBox, {.slices = 0, .standoff_mm = {}}, hand).empty());
}

TEST_CASE("trajectories: passes run side by side, across and askew, in steps of 0.5 to 1 mm") {
  const struct {
    std::uint32_t slices;
    double step_mm;
  } cases[] = {{100, 1}, {1000, 0.84}, {5000, 0.5}};
  for (const auto& c : cases) {
    Hand steady;
    steady.tremor_deg = steady.tremor_mm = 0;
    const Trajectory trajectory = pass_sweep(kBox, {.slices = c.slices, .standoff_mm = -10}, 30, steady);
    REQUIRE(trajectory.size() == c.slices);
    CHECK(all_rigid(trajectory));
    const std::uint32_t a_pass = c.slices / 5;
    double mean_step = 0;
    for (std::uint32_t pass = 0; pass < 5; ++pass) {
      const Eigen::Isometry3d &first = trajectory[pass * a_pass], &last = trajectory[(pass + 1) * a_pass - 1];
      mean_step += (last.translation() - first.translation()).norm() / (a_pass - 1) / 5;
      CHECK(degrees_between(normal(first), last.translation() - first.translation()) < 1e-4);
      CHECK(first.translation().y() == doctest::Approx(100 + 10));  // within the box, whose shortest edge is y
    }
    CHECK(mean_step >= 0.5 - 1e-9);
    CHECK(mean_step <= 1 + 1e-9);
    CHECK(mean_step == doctest::Approx(c.step_mm).epsilon(0.1));
    const auto heading = [&](std::uint32_t pass) { return normal(trajectory[pass * a_pass]); };
    CHECK(degrees_between(heading(0), heading(1)) < 1e-4);
    CHECK((trajectory[0].translation() - trajectory[a_pass].translation()).norm() == doctest::Approx(30));
    CHECK(degrees_between(heading(0), heading(2)) == doctest::Approx(90));
    CHECK(degrees_between(heading(2), heading(3)) < 1e-4);
    CHECK(degrees_between(heading(0), heading(4)) == doctest::Approx(37));
  }
}

TEST_CASE("trajectories: a probe held still trembles around one pose") {
  const Trajectory trajectory = still_probe(kBox, {.slices = 3000, .standoff_mm = {}}, Hand{});
  REQUIRE(trajectory.size() == 3000);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), mean_normal = Eigen::Vector3d::Zero();
  for (const Eigen::Isometry3d& pose : trajectory) {
    middle += pose.translation() / 3000;
    mean_normal += normal(pose) / 3000;
  }
  double deg2 = 0;
  for (const Eigen::Isometry3d& pose : trajectory)
    deg2 += std::pow(degrees_between(normal(pose), mean_normal.normalized()), 2);
  const double off = std::sqrt(deg2 / 3000);
  MESSAGE("normals " << off << " degrees off their mean");
  CHECK(off == doctest::Approx(1.5 * std::sqrt(2.0)).epsilon(0.15));  // about two of three axes
}
