#include <doctest/doctest.h>

#include <algorithm>

#include "core/reconstructor/reconstructor.h"
#include "tests/support/planes.h"

using namespace sonoloft;

namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d(0.3, -0.4, 1).normalized();
constexpr double kHalfSide_mm = 100, kLooked_mm = 30;

/// A slice of everything below the plane through 0 with the normal kUp, as far as it lies in a large square.
TrackedSlice half_space_slice(const Eigen::Isometry3d& frame, std::uint64_t id) {
  TrackedSlice slice;
  slice.id = id;
  slice.image_to_reference = frame;
  const Eigen::Vector2d across = (frame.linear().transpose() * kUp).head<2>();
  const double above = kUp.dot(frame.translation());
  const std::array<Eigen::Vector2d, 4> square = {{{-kHalfSide_mm, -kHalfSide_mm},
                                                  {kHalfSide_mm, -kHalfSide_mm},
                                                  {kHalfSide_mm, kHalfSide_mm},
                                                  {-kHalfSide_mm, kHalfSide_mm}}};
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = square[i], &b = square[(i + 1) % 4];
    const double height_a = across.dot(a) + above, height_b = across.dot(b) + above;
    if (height_a < 0) corners.push_back(a);
    if ((height_a < 0) != (height_b < 0)) corners.push_back(a + height_a / (height_a - height_b) * (b - a));
  }
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (double way = 0; way < 1; way += 0.005)  // slopes are those of points
      slice.points.push_back(corners[i] + way * (corners[(i + 1) % corners.size()] - corners[i]));
  slice.contours.push_back({0, static_cast<std::uint32_t>(slice.points.size()), 1, false});
  return slice;
}

}  // namespace

TEST_CASE("reconstructor: vertices beside slices lie on the surface as exactly as all others") {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.6, 0.5, 0.7).normalized();  // 50 degrees from the surface's
  std::vector<TrackedSlice> slices;
  for (const double height_mm : {-40, -20, 0, 20, 40})
    slices.push_back(half_space_slice(test::frame_at(height_mm * normal, normal), slices.size()));
  auto options = options_for(slices, 7);
  REQUIRE(options);
  options->device = DeviceChoice::cpu;
  options->caps = Caps::slice;
  auto reconstructor = Reconstructor::create(*options);
  REQUIRE(reconstructor);
  for (const TrackedSlice& slice : slices) REQUIRE(reconstructor->add(slice));
  REQUIRE(reconstructor->update());
  std::vector<double> beside, others;  // finest cells
  for (const Eigen::Vector3f& p : reconstructor->mesh().indexed().positions) {
    const Eigen::Vector3d at = p.cast<double>();
    if (at.norm() > kLooked_mm) continue;
    double nearest_mm = kLooked_mm;
    for (const TrackedSlice& slice : slices)
      nearest_mm = std::min(nearest_mm, std::abs((slice.image_to_reference.inverse() * at).z()));
    (nearest_mm < 2 * options->spacing_mm ? beside : others).push_back(std::abs(kUp.dot(at)) / options->spacing_mm);
  }
  const auto at_most = [](std::vector<double>& of, double share) {
    std::ranges::sort(of);
    return of[static_cast<std::size_t>(share * static_cast<double>(of.size() - 1))];
  };
  MESSAGE("finest cells off the surface, 50 % and 95 %: "
          << at_most(beside, 0.5) << " and " << at_most(beside, 0.95) << " of " << beside.size() << " beside slices, "
          << at_most(others, 0.5) << " and " << at_most(others, 0.95) << " of " << others.size() << " others");
  CHECK(beside.size() > 300);
  CHECK(at_most(beside, 0.5) < 0.015);
  CHECK(at_most(beside, 0.95) < 1.2 * at_most(others, 0.95));
}
