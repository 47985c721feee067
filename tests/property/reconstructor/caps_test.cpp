#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/reconstructor/reconstructor.h"
#include "core/reconstructor/stack_caps.h"
#include "tests/support/mesh/same_bytes.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// A disc of 10 mm seen at z = 0, 4, ..., every second slice upside down.
std::vector<TrackedSlice> stack(int count, double lean_rad = 0) {
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < count; ++i) {
    TrackedSlice slice;
    slice.id = static_cast<std::uint64_t>(i);
    slice.image_to_reference = test::frame_at({0, 0, 4.0 * i}, {std::sin(lean_rad * i), 0, std::cos(lean_rad * i)});
    if (i % 2 == 1) slice.image_to_reference.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    slice.contours.push_back({0, 100, 1, false});
    for (int k = 0; k < 100; ++k) {
      const double angle = 2 * std::numbers::pi * k / 100;
      slice.points.emplace_back(10 * std::cos(angle), 10 * std::sin(angle));
    }
    slices.push_back(std::move(slice));
  }
  return slices;
}

std::vector<Eigen::Isometry3d> frames(std::span<const TrackedSlice> slices) {
  std::vector<Eigen::Isometry3d> all;
  for (const TrackedSlice& slice : slices) all.push_back(slice.image_to_reference);
  return all;
}

/// Of a scan that has room for all of them; no slice yet.
Reconstructor open_scan(std::span<const TrackedSlice> slices, Caps caps, Admission admission = Admission::everything) {
  auto options = options_for(slices, 6);
  REQUIRE(options);
  options->device = DeviceChoice::cpu;
  options->caps = caps;
  options->admission = admission;
  auto reconstructor = Reconstructor::create(*options);
  REQUIRE(reconstructor);
  return std::move(*reconstructor);
}

/// The lowest and the highest point of the surface, brought up to date.
std::pair<float, float> extent(Reconstructor& reconstructor) {
  REQUIRE(reconstructor.update());
  const IndexedMesh mesh = reconstructor.mesh().indexed();
  REQUIRE(!mesh.positions.empty());
  std::pair<float, float> range{1e9f, -1e9f};
  for (const Eigen::Vector3f& p : mesh.positions) range = {std::min(range.first, p.z()), std::max(range.second, p.z())};
  return range;
}

std::pair<float, float> extent(Caps caps) {
  const std::vector<TrackedSlice> slices = stack(4);
  Reconstructor reconstructor = open_scan(slices, caps);
  for (const TrackedSlice& slice : slices) REQUIRE(reconstructor.add(slice));
  return extent(reconstructor);
}

}  // namespace

TEST_CASE("caps: of a stack, one gap or nothing beyond its first and last slice, whichever way they look") {
  for (const double gaps : {1.0, 0.0}) {
    const auto caps = stack_caps(frames(stack(4)), gaps, 0.1);
    REQUIRE(caps.size() == 2);
    CHECK(caps[0].translation().z() == doctest::Approx(gaps > 0 ? -4.0 : -0.1));
    CHECK(caps[1].translation().z() == doctest::Approx(gaps > 0 ? 16.0 : 12.1));
  }
}

TEST_CASE("caps: slices that lean against each other have none, nor has a single one") {
  CHECK(stack_caps(frames(stack(4, 0.02)), 1, 0.1).empty());
  CHECK(stack_caps(frames(stack(1)), 1, 0.1).empty());
}

TEST_CASE("caps: a probe at rest at the end of a stack does not close the gap") {
  std::vector<Eigen::Isometry3d> resting = frames(stack(4));
  for (int i = 0; i < 10; ++i) {
    resting.push_back(resting.back());
    resting.back().translation().z() += 0.001;
  }
  CHECK(stack_caps(resting, 1, 0.1)[1].translation().z() == doctest::Approx(16.0).epsilon(2e-3));
  CHECK(stack_caps(std::vector(5, resting.front()), 1, 0.1).empty());
}

TEST_CASE("caps: with them a cylinder ends within a gap of the last slices, closed ones at the slices") {
  const auto [gap_low, gap_high] = extent(Caps::gap);
  CHECK(gap_low > -3.0f);
  CHECK(gap_low < -1.0f);
  CHECK(gap_high < 15.0f);
  CHECK(gap_high > 13.0f);
  const auto [low, high] = extent(Caps::slice);
  CHECK(low > -0.3f);
  CHECK(low < 0.1f);
  CHECK(high < 12.3f);
  CHECK(high > 11.9f);
  CHECK(extent(Caps::box).second > 16.0f);
}

TEST_CASE("caps: they move on with a scan, and the mesh is that of all slices at once") {
  const std::vector<TrackedSlice> slices = stack(6);
  for (const Admission admission : {Admission::everything, Admission::news}) {
    Reconstructor live = open_scan(slices, Caps::gap, admission), batch = open_scan(slices, Caps::gap, admission);
    for (const TrackedSlice& slice : slices) {
      REQUIRE(live.add(slice));
      const auto [low, high] = extent(live);
      if (slice.id == 0) continue;  // one slice is no stack
      CHECK(low > -3.0f);
      CHECK(high > 4.0f * static_cast<float>(slice.id) + 1.0f);
      CHECK(high < 4.0f * static_cast<float>(slice.id) + 3.0f);
    }
    for (const TrackedSlice& slice : slices) REQUIRE(batch.add(slice));
    REQUIRE(batch.update());
    CHECK(test::same_bytes(live.mesh().indexed(), batch.mesh().indexed()));
    CHECK(live.counts().cells == 9);  // between 6 slices, their caps and the walls
    REQUIRE(live.withdraw(5));
    CHECK(extent(live).second < 19.0f);
    CHECK(!live.withdraw(5));
  }
}

TEST_CASE("caps: a slice that crosses the stack ends them, since it shows the ends itself") {
  std::vector<TrackedSlice> slices = stack(4);
  Reconstructor reconstructor = open_scan(slices, Caps::gap);
  for (const TrackedSlice& slice : slices) REQUIRE(reconstructor.add(slice));
  CHECK(extent(reconstructor).second < 15.0f);
  TrackedSlice across;
  across.id = 4;
  across.image_to_reference = test::frame_at({0, 0, 0}, {1, 0, 0});
  for (const Eigen::Vector3d& corner : {Eigen::Vector3d{0, -10, -20}, {0, 10, -20}, {0, 10, 30}, {0, -10, 30}})
    across.points.emplace_back((across.image_to_reference.inverse() * corner).head<2>());
  across.contours.push_back({0, 4, 1, false});
  REQUIRE(reconstructor.add(across));
  CHECK(extent(reconstructor).second > 25.0f);
}

TEST_CASE("caps: they count as nothing seen") {
  const std::vector<TrackedSlice> slices = stack(4);
  const auto seen = [&](Caps caps) {
    Reconstructor reconstructor = open_scan(slices, caps, Admission::news);
    for (const TrackedSlice& slice : slices) REQUIRE(reconstructor.add(slice));
    REQUIRE(reconstructor.update());
    const std::vector<Eigen::Vector3f> beyond{{0, 0, 13.5f}, {0, 0, 15.5f}};
    return std::pair(reconstructor.coverage().seen_mm3, reconstructor.confidence(beyond).distance_mm);
  };
  CHECK(seen(Caps::gap) == seen(Caps::box));
}
