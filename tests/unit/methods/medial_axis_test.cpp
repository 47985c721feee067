#include "core/methods/medial_axis/medial_axis.h"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "tests/support/mesh/contour_section.h"
#include "tests/support/planes.h"
#include "tests/support/stacks/stack_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr double kPi = std::numbers::pi;

/// Without fairing. Checked, with it and without: closed, and on every slice the slice's own contours.
ContourSurfaces surfaces(const std::vector<TrackedSlice>& slices) {
  for (const bool fairing : {true, false}) {
    auto made = medial_axis(slices, {fairing, 2});
    if (!made) FAIL(made.error().message);
    const ContourSection section = section_with(slices, *made);
    MESSAGE(made->triangles.size(), " triangles, ", section.text());
    CHECK(section.exact());
    CHECK(made->notes.empty());
    if (!fairing) return std::move(*made);
  }
  return {};
}

TrackedSlice placed(const Eigen::Isometry3d& frame, const std::vector<std::pair<Loop2d, Label>>& loops) {
  TrackedSlice slice;
  slice.image_to_reference = frame;
  for (const auto& [loop, label] : loops) add_loop(slice, loop, label);
  return slice;
}

/// Frames of the planes x = 0, y = 0, z = 0.
std::array<Eigen::Isometry3d, 3> axis_planes() {
  std::array<Eigen::Isometry3d, 3> frames;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Isometry3d& frame = frames[static_cast<std::size_t>(axis)];
    frame.setIdentity();
    for (Eigen::Index i = 0; i < 3; ++i) frame.linear().col(i) = Eigen::Vector3d::Unit((axis + i + 1) % 3);
  }
  return frames;
}

double area(const Loop2d& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d &a = loop[i], &b = loop[(i + 1) % loop.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

/// Where a plane cuts a ball or an ellipsoid with these half axes about the origin.
Loop2d cut_ellipsoid(const Eigen::Isometry3d& frame, const Eigen::Vector3d& axes, int corners) {
  const Eigen::Matrix<double, 3, 2> in_plane = axes.cwiseInverse().asDiagonal() * frame.linear().leftCols<2>();
  const Eigen::Vector3d origin = axes.cwiseInverse().cwiseProduct(frame.translation());
  const Eigen::Matrix2d form = in_plane.transpose() * in_plane;
  const Eigen::Vector2d centre = -form.inverse() * in_plane.transpose() * origin;
  const double rest = 1 - (origin + in_plane * centre).squaredNorm();
  Loop2d loop;
  if (rest <= 0) return loop;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(form);
  for (const Eigen::Vector2d& p : circle({0, 0}, std::sqrt(rest), corners))
    loop.push_back(centre + solver.operatorInverseSqrt() * p);
  return loop;
}

}  // namespace

TEST_CASE("medial-axis: between two parallel slices each disc reaches half-way, and half-way to the walls beyond") {
  for (const double radius : {10.0, 7.0}) {  // 10: both contours in one place of the sheet between them
    CAPTURE(radius);
    const std::vector<TrackedSlice> slices{slice_at(0, {circle({0, 0}, 10)}), slice_at(8, {circle({0, 0}, radius)})};
    const double volume = volumes_mm3(surfaces(slices)).at(1),
                 expected = 8 * 0.75 * (area(circle({0, 0}, 10)) + area(circle({0, 0}, radius)));
    MESSAGE("volume ", volume, " mm^3, by hand ", expected);
    CHECK(volume == doctest::Approx(expected).epsilon(1e-8));
  }
}

TEST_CASE("medial-axis: three orthogonal slices of a ball make the body that is known by hand") {
  constexpr double kRadius = 10;
  constexpr int kCorners = 64;
  const Loop2d loop = circle({0, 0}, kRadius, kCorners);
  std::vector<TrackedSlice> slices;
  for (const Eigen::Isometry3d& frame : axis_planes()) slices.push_back(placed(frame, {{loop, 1}}));
  // over a point of a slice the body is as high as the point is far from the nearer one of the other two slices
  double expected = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d &a = loop[i], &b = loop[(i + 1) % loop.size()];
    expected +=
        3 * 2 * std::abs(a.x() * b.y() - a.y() * b.x()) / 2 * (a.cwiseAbs().minCoeff() + b.cwiseAbs().minCoeff()) / 3;
  }
  const double volume = volumes_mm3(surfaces(slices)).at(1);
  MESSAGE("volume ", volume, " mm^3, by hand ", expected, ", of the ball ", 4.0 / 3 * kPi * std::pow(kRadius, 3));
  CHECK(volume == doctest::Approx(expected).epsilon(1e-9));
  CHECK(volume == doctest::Approx(16 * (1 - std::sqrt(0.5)) * std::pow(kRadius, 3)).epsilon(0.01));
}

TEST_CASE("medial-axis: labels that meet at junctions share their walls") {
  const auto two_halves = [](double height_mm, double border) {
    TrackedSlice slice = slice_at(height_mm, {});
    add_loop(slice, rectangle({-10, -10}, {border, 10}), 1);
    add_loop(slice, rectangle({border, -10}, {10, 10}), 2);
    add_loop(slice, rectangle({border - 3, -3}, {border + 4, 3}), 3);
    return slice;
  };
  const auto volumes = volumes_mm3(surfaces({two_halves(0, 1), two_halves(8, -2)}));
  CHECK(volumes.at(1) == doctest::Approx(8 * 0.75 * (20 * 11 - 18 + 20 * 8 - 18)).epsilon(1e-8));
  CHECK(volumes.at(2) == doctest::Approx(8 * 0.75 * (20 * 9 - 24 + 20 * 12 - 24)).epsilon(1e-8));
  CHECK(volumes.at(3) == doctest::Approx(8 * 0.75 * 2 * 42).epsilon(1e-8));
}

TEST_CASE("medial-axis: slices in random directions keep their contours, of any number of labels") {
  std::mt19937 rng(7);
  for (const int count : {1, 2, 5, 9}) {
    CAPTURE(count);
    std::vector<TrackedSlice> slices;
    for (int i = 0; i < count; ++i) {
      const Eigen::Isometry3d frame = random_frame(rng, 3);
      std::vector<std::pair<Loop2d, Label>> loops{{cut_ellipsoid(frame, {20, 14, 11}, 41), 1}};
      if (auto inner = cut_ellipsoid(frame, {11, 9, 5}, 23); !inner.empty()) loops.emplace_back(inner, 2);
      slices.push_back(placed(frame, loops));
    }
    CHECK(volumes_mm3(surfaces(slices)).at(1) > 0);
  }
}

TEST_CASE("medial-axis: slices that contradict each other on their common line make closed surfaces all the same") {
  std::vector<TrackedSlice> slices;
  for (const Eigen::Isometry3d& frame : axis_planes()) slices.push_back(placed(frame, {{circle({0, 0}, 10, 30), 1}}));
  add_loop(slices[0], circle({1, 0.5}, 4, 12), 2);
  slices[1].points.clear();
  slices[1].contours.clear();
  add_loop(slices[1], circle({3, -2}, 9, 17), 1);
  surfaces(slices);
}

TEST_CASE("medial-axis: contours along other slices, and slices through corners and through one line") {
  std::vector<TrackedSlice> slices;
  for (const Eigen::Isometry3d& frame : axis_planes())
    slices.push_back(placed(frame, {{rectangle({0, 0}, {10, 10}), 1}, {rectangle({-10, 0}, {0, 10}), 2}}));
  surfaces(slices);
  std::vector<TrackedSlice> fan;
  for (const double angle : {0.0, 0.5, 1.0, 1.5, 2.0, 2.5}) {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    frame.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).toRotationMatrix();
    fan.push_back(placed(frame, {{circle({0, 0}, 10, 30), 1}, {rectangle({-3, -4}, {5, 2}), 2}}));
  }
  surfaces(fan);
}

TEST_CASE("medial-axis: what these tests look at finds a hole, a moved contour and a vertex beyond a slice") {
  const std::vector<TrackedSlice> slices{slice_at(0, {circle({0, 0}, 10)}), slice_at(8, {circle({0, 0}, 7)})};
  const ContourSurfaces good = surfaces(slices);
  ContourSurfaces holed = good, moved = good, beyond = good;
  holed.triangles.pop_back();
  CHECK(section_with(slices, holed).open_edges == 3);
  moved.positions[0].x() += 1e-6;
  CHECK(section_with(slices, moved).strays == 4);  // two edges, from both sides
  for (std::size_t v = good.on_slices; v < good.positions.size(); ++v) beyond.positions[v].z() = 9;
  CHECK(section_with(slices, beyond).crossings > 0);
}

TEST_CASE("medial-axis: where the images have their origins does not matter") {
  TrackedSlice far = slice_at(8, {});
  far.image_to_reference.translation().x() = 5000;
  add_loop(far, circle({-5000, 0}, 7), 1);
  const double volume = volumes_mm3(surfaces({slice_at(0, {circle({0, 0}, 10)}), far})).at(1);
  CHECK(volume == doctest::Approx(8 * 0.75 * (area(circle({0, 0}, 10)) + area(circle({0, 0}, 7)))).epsilon(1e-7));
}

TEST_CASE("medial-axis: the number of threads changes nothing") {
  std::mt19937 rng(3);
  std::vector<TrackedSlice> slices;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Isometry3d frame = random_frame(rng, 3);
    slices.push_back(placed(frame, {{cut_ellipsoid(frame, {20, 14, 11}, 31), 1}}));
  }
  const auto one = medial_axis(slices, {true, 1}), four = medial_axis(slices, {true, 4});
  REQUIRE(one);
  REQUIRE(four);
  CHECK(one->positions == four->positions);
  CHECK(one->triangles == four->triangles);
  CHECK(one->label_front == four->label_front);
}

TEST_CASE("medial-axis: what it does not take is an error that says why, and a slice told twice is noted") {
  TrackedSlice slice = slice_at(0, {circle({0, 0}, 10)});
  TrackedSlice bounded = slice;
  bounded.field_of_view = rectangle({-20, -20}, {20, 20});
  const auto unknown = medial_axis(std::vector{slice, bounded}, {});
  REQUIRE(!unknown);
  CHECK(unknown.error().code == ErrorCode::invalid_argument);
  CHECK(unknown.error().message.find("slice 2 has some") != std::string::npos);
  const auto empty = medial_axis(std::vector{slice_at(0, {}), slice_at(4, {})}, {});
  REQUIRE(!empty);
  CHECK(empty.error().code == ErrorCode::empty_input);
  const auto twice = medial_axis(std::vector{slice, slice_at(4, {circle({0, 0}, 5)}), slice}, {});
  REQUIRE(twice);
  REQUIRE(twice->notes.size() == 1);
  CHECK(twice->notes[0].starts_with("slice 3 lies in the plane of one before"));
}
