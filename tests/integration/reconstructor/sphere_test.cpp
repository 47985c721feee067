#include <doctest/doctest.h>

#include <numbers>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// A slice of the ball of radius 40 around (5, -3, 2).
TrackedSlice ball_slice(const Eigen::Isometry3d& frame, std::uint64_t id) {
  TrackedSlice slice;
  slice.id = id;
  slice.image_to_reference = frame;
  const Eigen::Vector3d local = frame.inverse() * Eigen::Vector3d(5, -3, 2);
  const double r2 = 1600.0 - local.z() * local.z();
  if (r2 <= 0.0) return slice;
  constexpr int kSides = 200;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    slice.points.push_back(local.head<2>() + std::sqrt(r2) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  slice.contours.push_back({0, kSides, 1, false});
  return slice;
}

}  // namespace

TEST_CASE("reconstructor: a ball from 20 slices in free orientations has its volume within 5 %") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> uniform(-35.0, 35.0);
    std::vector<TrackedSlice> slices;
    for (std::uint64_t i = 0; i < 20; ++i) {
      const Eigen::Vector3d normal = test::random_direction(rng);
      slices.push_back(ball_slice(test::frame_at(Eigen::Vector3d(5, -3, 2) + uniform(rng) * normal, normal), i));
    }
    auto options = options_for(slices, 7);
    REQUIRE(options);
    options->device = DeviceChoice::cpu;
    options->threads = 2;
    auto reconstructor = Reconstructor::create(*options);
    REQUIRE(reconstructor);
    for (const TrackedSlice& slice : slices) REQUIRE(reconstructor->add(slice));
    REQUIRE(reconstructor->update());
    const test::MeshReport report = test::check_mesh(reconstructor->mesh().indexed());
    CHECK_MESSAGE(report.closed_manifold(), report.text());
    CHECK(report.labels.at(1).components == 1);
    CHECK(report.labels.at(1).genus() == 0);
    const double truth = 4.0 / 3.0 * std::numbers::pi * 64000.0;
    const double volume = report.labels.at(1).volume_mm3;
    MESSAGE("seed " << seed << ": volume " << 100.0 * (volume / truth - 1.0) << " % off");
    CHECK(std::abs(volume / truth - 1.0) < 0.05);
  }
}
