#include <doctest/doctest.h>

#include <array>

#include "core/methods/stack/signed_distance.h"
#include "core/methods/stack/slice_stack.h"
#include "tests/support/planes.h"
#include "tests/support/slice_truth.h"
#include "tests/support/stacks/stack_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

Error error_of(const std::vector<TrackedSlice>& slices) {
  const auto stack = make_stack(slices, "metamorphosis");
  REQUIRE(!stack);
  MESSAGE(stack.error().message);
  return stack.error();
}

}  // namespace

TEST_CASE("stack: what no stack can take is an error that names the slice, and what takes it") {
  TrackedSlice oblique = slice_at(5, {circle({0, 0}, 10)}), shadowed = slice_at(5, {circle({0, 0}, 10)});
  oblique.image_to_reference.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  add_loop(shadowed, circle({5, 0}, 3), kUnknown);
  const TrackedSlice first = slice_at(0, {circle({0, 0}, 10)}), empty = slice_at(7, {});
  for (const TrackedSlice& bad : {oblique, shadowed, first}) {
    const Error error = error_of({first, bad});
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.message.find("metamorphosis takes two or more parallel slices") == 0);
    CHECK(error.message.find("2") != std::string::npos);
    CHECK(error.message.find("without --method") != std::string::npos);
  }
  TrackedSlice sheared = slice_at(5, {circle({0, 0}, 10)}), infinite = sheared;
  sheared.image_to_reference.linear()(0, 1) = 0.1;
  infinite.points[3].x() = std::numeric_limits<double>::infinity();
  CHECK(error_of({first, sheared}).code == ErrorCode::not_rigid);
  CHECK(error_of({first, infinite}).code == ErrorCode::non_finite);
  CHECK(error_of({first}).code == ErrorCode::invalid_argument);
  CHECK(error_of({}).code == ErrorCode::invalid_argument);
  CHECK(error_of({empty, empty}).code == ErrorCode::empty_input);
}

TEST_CASE("stack: slices in any order, turned in their planes and seen from behind are the same stack") {
  std::mt19937 random(7);
  const Eigen::Isometry3d frame = random_frame(random, 50);
  std::vector<TrackedSlice> slices;
  for (const double height : {6.0, 0.0, 3.5}) {
    TrackedSlice slice = slice_at(height, {circle({1, 2}, 10 + height)});
    Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
    turn.linear() = Eigen::AngleAxisd(height, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    if (height > 5)
      turn.linear() = turn.linear() * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
    for (Eigen::Vector2d& p : slice.points) p = (turn.inverse() * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>();
    slice.image_to_reference = frame * slice.image_to_reference * turn;
    slices.push_back(slice);
  }
  const auto stack = make_stack(slices, "test");
  REQUIRE(stack);
  REQUIRE(stack->sections.size() == 3);
  // The first slice, at 6, was seen from behind, so the stack is: its lowest section is that slice.
  for (std::size_t i = 0; i < 3; ++i) {
    const double height = stack->heights_mm[i];
    const double radius = std::array{16.0, 13.5, 10.0}[i];
    CHECK(stack->slices[i] == std::array<std::size_t, 3>{1, 3, 2}[i]);
    for (const Eigen::Vector2d& p : stack->sections[i].points) {
      const Eigen::Vector3d at = frame.inverse() * (stack->stack_to_reference * Eigen::Vector3d(p.x(), p.y(), height));
      CHECK(at.z() == doctest::Approx(6 - std::array{0.0, 2.5, 6.0}[i]).scale(1));
      CHECK((at.head<2>() - Eigen::Vector2d(1, 2)).norm() == doctest::Approx(radius));
    }
  }
  CHECK(stack->labels == std::vector<Label>{0, 1});
}

TEST_CASE("stack: signed distances are those to the contours of a label, holes and neighbours among them") {
  TrackedSlice slice = slice_at(2, {circle({0, 0}, 9.3, 40), circle({14, 3}, 3.1, 24)});
  add_loop(slice, circle({-3, 1}, 2.7, 12), 2);
  slice.contours[1].label = 3;
  const auto section = make_section(slice);
  REQUIRE(section);
  const SliceTruth truth(slice);
  const PlaneGrid grid{0.41, {-35, -33}, 90, 70};
  for (const Label label : std::to_array<Label>({1, 2, 3})) {
    const auto distances = signed_distance(
        *section, [&](Label l) { return l == label; }, grid, -100);
    double worst_near = 0, worst = 0;
    for (std::size_t n = 0; n < grid.size(); ++n) {
      const Eigen::Vector2i at = grid.node(n);
      const Eigen::Vector2d p = grid.point(at.x(), at.y());
      double nearest = 1e9;
      for (const SectionEdge& e : section->edges) {
        if ((e.left == label) == (e.right == label)) continue;
        const Eigen::Vector2d a = section->points[e.a], d = section->points[e.b] - a;
        nearest = std::min(nearest, (p - a - std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm());
      }
      const double truth_mm = truth.label_at(p) == label ? nearest : -nearest;
      const double off = std::abs(truth_mm - static_cast<double>(distances[n])) / grid.spacing_mm;
      worst = std::max(worst, off);
      if (nearest < 2 * grid.spacing_mm) worst_near = std::max(worst_near, off);
    }
    MESSAGE("label ", label, ": at most ", worst_near, " nodes off near contours, ", worst, " elsewhere");
    CHECK(worst_near < 1e-4);
    CHECK(worst < 0.1);
  }
  CHECK(signed_distance(
            *section, [](Label l) { return l == 7; }, grid, -100) == std::vector<float>(grid.size(), -100));
}
