#include "host/apps/measure/accuracy.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/mesh/solid_meshes.h"
#include "tests/support/planes.h"

using namespace sonoloft;
using namespace sonoloft::test;
using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSides = 96;

Vector3d around(double radius, double z, int side) {
  const double angle = 2 * kPi * side / kSides;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// The surface of a profile (radius, z) turned about z; label 1 inside. A closed profile gives a ring, runs of radius 0
/// at both ends a ball.
IndexedMesh revolved(const std::vector<Eigen::Vector2d>& profile, bool closed = false) {
  IndexedMesh mesh;
  for (const Eigen::Vector2d& p : profile)
    for (int side = 0; side < kSides; ++side) mesh.positions.push_back(around(p.x(), p.y(), side).cast<float>());
  for (std::size_t i = 0; i + (closed ? 0 : 1) < profile.size(); ++i)
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const auto low = static_cast<std::uint32_t>(i * kSides), next = (side + 1) % kSides;
      const auto high = static_cast<std::uint32_t>((i + 1) % profile.size() * kSides);
      mesh.triangles.push_back({low + side, low + next, high + next});
      mesh.triangles.push_back({low + side, high + next, high + side});
    }
  mesh.label_front.assign(mesh.triangles.size(), 0);
  mesh.label_back.assign(mesh.triangles.size(), 1);
  return mesh;
}

/// A ridge: the radius falls by tan(angle) on both sides of z = 0.
IndexedMesh ridge(double angle_deg) {
  return revolved({{0, -10},
                   {20 - 10 * std::tan(angle_deg * kPi / 180), -10},
                   {20, 0},
                   {20 - 10 * std::tan(angle_deg * kPi / 180), 10},
                   {0, 10}});
}

TrackedSlice circle_at(double z, double radius) {
  TrackedSlice slice;
  slice.image_to_reference = frame_at({0, 0, z}, Vector3d::UnitZ());
  for (int side = 0; side < kSides; ++side) slice.points.push_back(around(radius, 0, side).head<2>());
  slice.contours = {{0, kSides, 1, false}};
  return slice;
}

double degrees(double length) {
  return length * 180 / kPi;
}

}  // namespace

TEST_CASE("agreement: two boxes agree as their volumes say, on the same points with any number of threads") {
  const Eigen::AlignedBox3d all(Vector3d(0, 0, 0), Vector3d(20, 10, 10));
  const auto box = [](double low, double high, Label label) {
    return [=](const Vector3d& p) -> Label { return p.x() >= low && p.x() < high ? label : kOutside; };
  };
  const Agreement one = agreement(all, box(2, 12, 1), box(5, 15, 1), 1);
  REQUIRE(one.labels.size() == 1);
  MESSAGE("IoU ", one.mean_iou(), " (", 7.0 / 13, "), mislabelled ", one.mislabelled, " (0.3)");
  CHECK(std::abs(one.mean_iou() - 7.0 / 13) < 0.005);
  CHECK(std::abs(one.mislabelled - 0.3) < 0.005);
  const Agreement again = agreement(all, box(2, 12, 1), box(5, 15, 1), 3);
  CHECK(again.labels[0].common == one.labels[0].common);
  CHECK(again.mislabelled == one.mislabelled);
}

TEST_CASE("agreement: a wrong label counts against both labels") {
  const Eigen::AlignedBox3d all(Vector3d(0, 0, 0), Vector3d(1, 1, 1));
  const auto halves = [](double wall) { return [=](const Vector3d& p) -> Label { return p.x() < wall ? 3 : 8; }; };
  const Agreement result = agreement(all, halves(0.6), halves(0.5), 2);
  REQUIRE(result.labels.size() == 2);
  CHECK(result.labels[0].label == 3);
  CHECK(std::abs(result.labels[0].iou() - 5.0 / 6) < 0.005);
  CHECK(result.labels[1].label == 8);
  CHECK(std::abs(result.labels[1].iou() - 0.8) < 0.005);
  CHECK(std::abs(result.mislabelled - 0.1) < 0.005);
}

TEST_CASE("pieces: hollows count, small ones are told from large ones, and a ring has a handle") {
  const IndexedMesh hollow = together(sphere_mesh({0, 0, 0}, 10, 3), sphere_mesh({0, 0, 0}, 6, 3, 1, 0));
  const IndexedMesh with_crumb = together(hollow, sphere_mesh({30, 0, 0}, 1, 3));
  const Pieces pieces = count_pieces(with_crumb, 100);
  CHECK(pieces.all == 3);
  CHECK(pieces.large == 2);
  CHECK(pieces.genus == 0);
  const IndexedMesh ring = revolved({{20, -2}, {24, -2}, {24, 2}, {20, 2}}, true);
  CHECK(count_pieces(ring, 100).genus == 1);
  CHECK(count_pieces(together(ring, with_crumb), 100).all == 4);
}

TEST_CASE("passage: a wall that is straight across a slice does not turn, a ridge turns by both its angles") {
  const std::vector<TrackedSlice> slices{circle_at(0, 20)};
  const SliceNormals straight = normals_at_slices(ridge(0), slices, 2);
  CHECK(straight.size() == 63);  // of 2 mm along 40 pi mm, but for the last
  CHECK(compare_passage(straight, straight).turn_deg < 1e-4);
  for (const double angle : {5.0, 20.0, 45.0}) {
    const SlicePassage passage = compare_passage(normals_at_slices(ridge(angle), slices, 2), straight);
    MESSAGE("ridge of ", angle, " degrees a side: turn ", passage.turn_deg, ", crease ", passage.crease_deg);
    CHECK(passage.turn_deg == doctest::Approx(2 * angle).epsilon(0.01));
    CHECK(passage.crease_deg == doctest::Approx(degrees(2 * std::sin(angle * kPi / 180))).epsilon(0.01));
    CHECK(passage.truth_turn_deg < 1e-4);
    CHECK(passage.lean_deg < 0.5);
    for (const double quartile : passage.turn_quartiles_deg)
      CHECK(quartile == doctest::Approx(2 * angle).epsilon(0.01));
    CHECK(passage.along_deg == doctest::Approx(degrees(2.0 / 20)).epsilon(0.02));  // of a circle, 2 mm apart
  }
}

TEST_CASE("passage: the last stretch of a contour and the first of another do not follow each other") {
  const Vector3d up(0, 0, 1);
  const std::array<Vector3d, 2> north{Vector3d::UnitY(), Vector3d::UnitY()}, east{Vector3d::UnitX(), Vector3d::UnitX()};
  const SliceNormals normals{{{0, 0, 0, 1}, north}, {{0, 1, 0, 1}, north}, {{0, 3, 0, 1}, east}, {{1, 4, 0, 1}, north}};
  CHECK(compare_passage(normals, normals).along_deg == 0);
  TrackedSlice two = circle_at(0, 20);
  for (int side = 0; side < kSides; ++side) two.points.push_back(two.points[static_cast<std::size_t>(side)]);
  for (int side = 0; side < kSides; ++side) two.points[static_cast<std::size_t>(side)].x() += 100;
  two.contours.push_back({kSides, kSides, 1, false});
  const SliceNormals of_second = normals_at_slices(ridge(0), std::vector{two}, 2);
  CHECK(of_second.size() == 63);
  CHECK(std::get<1>(of_second.begin()->first) == 64);  // the first has 63 too
}

TEST_CASE("passage: a cone whose surface stands upright at the slice leans by its angle and has no crease") {
  const std::vector<TrackedSlice> slices{circle_at(0, 20)};
  const IndexedMesh cone = revolved({{0, -10}, {30, -10}, {10, 10}, {0, 10}});
  const IndexedMesh stepped = revolved({{0, -10}, {30, -10}, {20, -4}, {20, 4}, {10, 10}, {0, 10}});
  const SlicePassage passage =
      compare_passage(normals_at_slices(stepped, slices, 2), normals_at_slices(cone, slices, 2));
  CHECK(passage.lean_deg == doctest::Approx(45).epsilon(0.01));
  CHECK(passage.crease_deg < 0.5);
}

TEST_CASE("passage: places near another slice are left out") {
  CHECK(normals_at_slices(ridge(10), std::vector{circle_at(0, 20), circle_at(3.9, 19)}, 2).empty());
  CHECK(normals_at_slices(ridge(10), std::vector{circle_at(0, 20), circle_at(4.1, 19)}, 2).size() > 100);
}

TEST_CASE("accuracy: a mesh is its own truth; one within another is measured as geometry says") {
  const std::vector<TrackedSlice> slices{circle_at(0, 20)};
  const IndexedMesh truth = sphere_mesh({0, 0, 0}, 20, 5), smaller = sphere_mesh({0, 0, 0}, 19, 5);
  const auto own = measure_accuracy(truth, slices, {truth}, 2);
  REQUIRE(own);
  CHECK(own->agreement.mean_iou() == 1);
  CHECK(own->agreement.mislabelled == 0);
  CHECK(own->distance.max_mm < 1e-5);
  CHECK(own->passage.crease_deg == 0);
  CHECK(own->passage.lean_deg == 0);
  CHECK(own->passage.turn_deg == doctest::Approx(degrees(0.01 * own->diagonal_mm / 20)).epsilon(0.1));
  const auto less = measure_accuracy(smaller, slices, {truth}, 2);
  REQUIRE(less);
  CHECK(std::abs(less->agreement.mean_iou() - std::pow(0.95, 3)) < 0.005);
  CHECK(less->distance.mean_mm == doctest::Approx(1).epsilon(0.01));
  const auto by_formula = measure_accuracy(
      smaller, slices, {truth, [](const Vector3d& p) -> Label { return p.norm() < 19 ? 1 : kOutside; }}, 2);
  REQUIRE(by_formula);
  CHECK(by_formula->agreement.mean_iou() > 0.995);
}

TEST_CASE("accuracy: a mesh without triangles is wrong everywhere; a truth inside out is refused with the remedy") {
  const IndexedMesh truth = sphere_mesh({0, 0, 0}, 20, 3);
  const auto none = measure_accuracy({}, {}, {truth}, 1);
  REQUIRE(none);
  CHECK(none->agreement.mean_iou() == 0);
  CHECK(std::isinf(none->distance.mean_mm));
  CHECK(none->pieces.all == 0);
  const auto inside_out = measure_accuracy(truth, {}, {sphere_mesh({0, 0, 0}, 20, 3, 1, 0)}, 1);
  REQUIRE_FALSE(inside_out);
  CHECK(inside_out.error().message.find("turn its triangles") != std::string::npos);
  CHECK_FALSE(measure_accuracy(truth, {}, {IndexedMesh{}}, 1));
}
