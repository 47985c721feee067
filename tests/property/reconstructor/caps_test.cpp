#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/reconstructor/reconstructor.h"
#include "core/reconstructor/stack_caps.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

/// A disc of 10 mm seen at z = 0, 4, 8, 12, every second slice upside down.
std::vector<TrackedSlice> stack(double lean_rad = 0) {
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < 4; ++i) {
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

/// The lowest and the highest point of the surface.
std::pair<float, float> extent(double gaps) {
  std::vector<TrackedSlice> slices = stack();
  auto options = options_for(slices, 6);
  REQUIRE(options);
  options->device = DeviceChoice::cpu;
  auto reconstructor = Reconstructor::create(*options);
  REQUIRE(reconstructor);
  for (const TrackedSlice& cap : stack_caps(slices, gaps, 0.5 * options->spacing_mm)) slices.push_back(cap);
  for (const TrackedSlice& slice : slices) REQUIRE(reconstructor->add(slice));
  REQUIRE(reconstructor->update());
  const IndexedMesh mesh = reconstructor->mesh().indexed();
  REQUIRE(!mesh.positions.empty());
  std::pair<float, float> range{1e9f, -1e9f};
  for (const Eigen::Vector3f& p : mesh.positions) range = {std::min(range.first, p.z()), std::max(range.second, p.z())};
  return range;
}

}  // namespace

TEST_CASE("caps: of a stack, one gap or nothing beyond its first and last slice, whichever way they look") {
  for (const double gaps : {1.0, 0.0}) {
    const std::vector<TrackedSlice> caps = stack_caps(stack(), gaps, 0.1);
    REQUIRE(caps.size() == 2);
    for (const TrackedSlice& cap : caps) CHECK(cap.contours.empty());
    CHECK(caps[0].image_to_reference.translation().z() == doctest::Approx(gaps > 0 ? -4.0 : -0.1));
    CHECK(caps[1].image_to_reference.translation().z() == doctest::Approx(gaps > 0 ? 16.0 : 12.1));
  }
}

TEST_CASE("caps: slices that lean against each other have none, nor has a single one") {
  CHECK(stack_caps(stack(0.02), 1, 0.1).empty());
  CHECK(stack_caps(std::vector<TrackedSlice>{stack()[0]}, 1, 0.1).empty());
}

TEST_CASE("caps: with them a cylinder ends within a gap of the last slices, closed ones at the slices") {
  const auto [gap_low, gap_high] = extent(1);
  CHECK(gap_low > -3.0f);
  CHECK(gap_low < -1.0f);
  CHECK(gap_high < 15.0f);
  CHECK(gap_high > 13.0f);
  const auto [low, high] = extent(0);
  CHECK(low > -0.3f);
  CHECK(low < 0.1f);
  CHECK(high < 12.3f);
  CHECK(high > 11.9f);
}
