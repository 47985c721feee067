#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/mesh/mesh_labels.h"
#include "tests/support/view_slices.h"

using namespace sonoloft;

namespace {

constexpr double kReach_mm = 60;
constexpr double kFirstMissing = 0.6 * std::numbers::pi;  ///< a fan's planes stop here, of half a turn
constexpr int kPlanes = 30;

/// An organ with lesions that do not touch each other; no plane of the fan meets the first of them.
std::vector<test::Ball> random_body(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<test::Ball> balls{{{0, 0, 0}, kReach_mm, 1}};
  const double angle = 0.79 * std::numbers::pi + (uniform(rng) < 0 ? std::numbers::pi : 0);
  balls.push_back({{35 * std::cos(angle), 35 * std::sin(angle), 10 * uniform(rng)}, 15, 2});
  for (int attempt = 0; attempt < 2000 && balls.size() < 9; ++attempt) {
    const test::Ball ball{kReach_mm * Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)), 12 + 3 * uniform(rng),
                          2};
    if (ball.centre.norm() + ball.radius > kReach_mm - 3) continue;
    if (std::all_of(balls.begin() + 1, balls.end(), [&](const test::Ball& other) {
          return (other.centre - ball.centre).norm() > other.radius + ball.radius + 2;
        }))
      balls.push_back(ball);
  }
  return balls;
}

TrackedSlice view(const Eigen::Isometry3d& frame, const std::vector<test::Ball>& body) {
  const Eigen::Vector3d middle = frame.inverse() * Eigen::Vector3d::Zero();
  return test::slice_of_balls(frame, body, test::ring(middle.head<2>(), kReach_mm + 8, 40));
}

/// Planes through the z axis, with a wedge left out.
Reconstructor scan_fan(const std::vector<test::Ball>& body) {
  ReconstructorOptions options;
  options.box = {Eigen::Vector3d::Constant(-120), Eigen::Vector3d::Constant(120)};
  options.spacing_mm = 3;
  options.background_mm = 4;
  options.device = DeviceChoice::cpu;
  options.threads = 2;
  auto reconstructor = Reconstructor::create(options);
  REQUIRE(reconstructor);
  for (int i = 0; i < kPlanes; ++i) {
    const double angle = kFirstMissing * i / kPlanes;
    REQUIRE(reconstructor->add(view(test::frame_at({0, 0, 0}, {-std::sin(angle), std::cos(angle), 0}), body)));
  }
  REQUIRE(reconstructor->update());
  return std::move(*reconstructor);
}

/// The share of points of the organ of which the mesh has the wrong label.
double error(const Reconstructor& reconstructor, const std::vector<test::Ball>& body) {
  const IndexedMesh mesh = reconstructor.mesh().indexed();
  const test::MeshLabels labels(mesh);
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-kReach_mm, kReach_mm);
  int wrong = 0, points = 0;
  while (points < 6000) {
    const Eigen::Vector3d p(uniform(rng), uniform(rng), uniform(rng));
    if (p.norm() > kReach_mm) continue;
    ++points;
    const bool lesion = std::any_of(body.begin() + 1, body.end(),
                                    [&](const test::Ball& ball) { return (p - ball.centre).norm() < ball.radius; });
    wrong += labels.at(p) != (lesion ? 2 : 1);
  }
  return static_cast<double>(wrong) / points;
}

double error_with(Reconstructor scan, const Eigen::Isometry3d& plane, const std::vector<test::Ball>& body) {
  REQUIRE(scan.add(view(plane, body)));
  REQUIRE(scan.update());
  return error(scan, body);
}

}  // namespace

TEST_CASE("coverage: the gap of a fan with a wedge left out lies in it, and its plane helps more than a random one") {
  int in_wedge = 0;
  constexpr int kSeeds = 20;
  double before = 0, suggested = 0, random = 0, seen = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937 rng(seed);
    const std::vector<test::Ball> body = random_body(rng);
    Reconstructor scan = scan_fan(body);
    const Coverage coverage = scan.coverage();
    REQUIRE(coverage.largest_gap);
    const CoverageGap& gap = *coverage.largest_gap;
    CHECK(gap.volume_mm3 <= coverage.volume_mm3 - coverage.seen_mm3 + 1e-3);
    CHECK(gap.deepest_mm > 8);
    seen += coverage.seen_fraction() / kSeeds;
    const double angle = std::atan2(gap.centre_mm.y(), gap.centre_mm.x());
    const double half_turn = angle < 0 ? angle + std::numbers::pi : angle;
    in_wedge += half_turn > 0.58 * std::numbers::pi;  // where the last plane is
    before += error(scan, body) / kSeeds;
    suggested += error_with(scan_fan(body), gap.suggested_image_to_reference, body) / kSeeds;
    random += error_with(scan_fan(body), test::random_frame(rng, 30), body) / kSeeds;
  }
  MESSAGE("seen " << seen << "; the gap lies in the wedge in " << in_wedge << " of " << kSeeds << "; wrong labels "
                  << before << " before, " << suggested << " with the plane suggested, " << random
                  << " with a random one");
  CHECK(in_wedge >= 18);
  CHECK(suggested < random);
  CHECK(seen > 0.3);
  CHECK(seen < 0.95);
}

TEST_CASE("confidence: a surface that slices ran through is measured and near, one that they did not see is not") {
  std::mt19937 rng(3);
  Reconstructor scan = scan_fan({{{0, 0, 0}, 40, 1}});
  const IndexedMesh mesh = scan.mesh().indexed();
  const Confidence confidence = scan.confidence(mesh.positions);
  REQUIRE(confidence.measured.size() == mesh.positions.size());
  double measured[2] = {0, 0}, distance_mm[2] = {0, 0}, count[2] = {0, 0};
  double worst_mm = 0;
  for (std::size_t v = 0; v < confidence.measured.size(); ++v) {
    const Eigen::Vector3d p = mesh.positions[v].cast<double>();
    const double angle = std::atan2(p.y(), p.x()), half_turn = angle < 0 ? angle + std::numbers::pi : angle;
    double truth_mm = 1e9;
    for (int i = 0; i < kPlanes; ++i) {
      const double a = kFirstMissing * i / kPlanes;
      truth_mm = std::min(truth_mm, std::abs(p.dot(Eigen::Vector3d(-std::sin(a), std::cos(a), 0))));
    }
    worst_mm = std::max(worst_mm, std::abs(std::min(truth_mm, 32.0) - static_cast<double>(confidence.distance_mm[v])));
    if (p.head<2>().norm() < 20) continue;
    const int wedge = half_turn > 0.7 * std::numbers::pi && half_turn < 0.85 * std::numbers::pi ? 1 : 0;
    if (wedge == 0 && half_turn > 0.5 * std::numbers::pi) continue;
    measured[wedge] += static_cast<double>(confidence.measured[v]);
    distance_mm[wedge] += static_cast<double>(confidence.distance_mm[v]);
    ++count[wedge];
  }
  MESSAGE("between planes: measured " << measured[0] / count[0] << ", " << distance_mm[0] / count[0]
                                      << " mm; in the wedge " << measured[1] / count[1] << ", "
                                      << distance_mm[1] / count[1] << " mm; distance off by at most " << worst_mm);
  CHECK(measured[0] / count[0] > 0.9);
  CHECK(measured[1] / count[1] < measured[0] / count[0]);
  CHECK(distance_mm[1] / count[1] > 3 * distance_mm[0] / count[0]);
  CHECK(worst_mm <= 1.2 * 4);
}
