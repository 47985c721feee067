#include "core/methods/metamorphosis/metamorphosis.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "tests/support/mesh/contour_distance.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/stacks/stack_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr double kCell = 0.5;

MethodSurfaces morph(const std::vector<TrackedSlice>& slices, StackEnds ends = StackEnds::flat, int threads = 2) {
  auto surfaces = metamorphosis(slices, {kCell, ends, threads});
  if (!surfaces) FAIL(surfaces.error().message);
  const MeshReport report = check_mesh(surfaces->mesh);
  CHECK_MESSAGE(report.closed_manifold(), report.text());
  return std::move(*surfaces);
}

std::vector<TrackedSlice> circles(const std::vector<double>& radii, double step_mm) {
  std::vector<TrackedSlice> slices;
  for (const double radius : radii)
    slices.push_back(slice_at(step_mm * static_cast<double>(slices.size()), {circle({0, 0}, radius, 360)}));
  return slices;
}

double radius_of(const Eigen::Vector3f& p) {
  return static_cast<double>(p.head<2>().norm());
}

double largest(const std::vector<double>& values) {
  return *std::ranges::max_element(values);
}

std::pair<float, float> heights(const IndexedMesh& mesh) {
  const auto [low, high] =
      std::ranges::minmax_element(mesh.positions, {}, [](const Eigen::Vector3f& p) { return p.z(); });
  return {low->z(), high->z()};
}

}  // namespace

TEST_CASE("metamorphosis: between two circles runs the cone") {
  const IndexedMesh mesh = morph(circles({30, 10}, 16)).mesh;
  double worst = 0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    const auto z = static_cast<double>(p.z());
    if (z > kCell && z < 16 - kCell) worst = std::max(worst, std::abs(radius_of(p) - (30 - 20 * z / 16)) / kCell);
  }
  MESSAGE("at most ", worst, " cells off");
  CHECK(worst < 0.25);
}

TEST_CASE("metamorphosis: a step between equal contours is passed without overshooting") {
  const IndexedMesh mesh = morph(circles({10, 10, 20, 20}, 8)).mesh;
  double least = 1e9, most = 0, lower_step = 0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (p.z() < 0.6F || p.z() > 23.4F) continue;
    least = std::min(least, radius_of(p));
    most = std::max(most, radius_of(p));
    if (p.z() < 8) lower_step = std::max(lower_step, radius_of(p));
  }
  MESSAGE("radii ", least, " to ", most, "; below the step at most ", lower_step);
  CHECK(least > 10 - 0.1 * kCell);
  CHECK(most < 20 + 0.1 * kCell);
  CHECK(lower_step < 10 + 0.1 * kCell);
}

TEST_CASE("metamorphosis: a wall that moves by less than a cell from slice to slice has no pits") {
  const IndexedMesh mesh = morph(circles({20, 20.03, 20.11, 20.05, 20.2}, 6)).mesh;
  double least = 1e9, most = 0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (p.z() < 0.6F || p.z() > 23.4F) continue;
    least = std::min(least, radius_of(p));
    most = std::max(most, radius_of(p));
  }
  MESSAGE("radii ", least, " to ", most);
  CHECK(least > 20 - 0.1 * kCell);
  CHECK(most < 20.2 + 0.1 * kCell);
}

TEST_CASE("metamorphosis: one contour splits into two and they merge again") {
  const Loop2d whole = ellipse({0, 0}, 16, 8), left = circle({-8, 0}, 5), right = circle({8, 0}, 5);
  const auto surfaces = morph({slice_at(0, {whole}), slice_at(6, {left, right}), slice_at(12, {whole})});
  const LabelReport body = check_mesh(surfaces.mesh).labels.at(1);
  CHECK(body.components == 1);
  CHECK(body.genus() == 1);
  CHECK(surfaces.notes.empty());
  CHECK(count_self_intersections(surfaces.mesh) == 0);
}

TEST_CASE("metamorphosis: a circle becomes a square becomes four circles, and the square keeps its corners") {
  const std::vector<TrackedSlice> slices{
      slice_at(0, {circle({0, 0}, 12)}), slice_at(8, {rectangle({-15, -15}, {15, 15})}),
      slice_at(16, {circle({-9, -9}, 5), circle({9, -9}, 5), circle({9, 9}, 5), circle({-9, 9}, 5)})};
  const IndexedMesh mesh = morph(slices).mesh;
  const double corners = largest(contour_distances(std::span(slices).subspan(1, 1), mesh)) / kCell;
  const double all = largest(contour_distances(slices, mesh)) / kCell;
  MESSAGE("from the mesh: corners of the square ", corners, ", all contours at most ", all, " cells");
  CHECK(corners < 0.5);
  CHECK(all < 0.5);
  CHECK(check_mesh(mesh).labels.at(1).components == 1);
}

TEST_CASE("metamorphosis: a contour that overlaps nothing in the next slice is closed half-way, and noted") {
  const auto surfaces = morph({slice_at(0, {circle({-20, 0}, 8)}), slice_at(8, {circle({20, 0}, 8)})});
  REQUIRE(surfaces.notes.size() == 2);
  CHECK(surfaces.notes[0].find("label 1: 1 parts and 0 holes of slice 1") == 0);
  CHECK(surfaces.notes[1].find("of slice 2") != std::string::npos);
  CHECK(check_mesh(surfaces.mesh).labels.at(1).components == 2);
  float highest_left = 0, lowest_right = 8;
  for (const Eigen::Vector3f& p : surfaces.mesh.positions)
    if (p.x() < 0)
      highest_left = std::max(highest_left, p.z());
    else
      lowest_right = std::min(lowest_right, p.z());
  CHECK(highest_left == doctest::Approx(4).epsilon(0.1));
  CHECK(lowest_right == doctest::Approx(4).epsilon(0.1));
}

TEST_CASE("metamorphosis: a hole that is in one slice only is closed half-way on both sides") {
  TrackedSlice ring = slice_at(8, {circle({0, 0}, 12), circle({0, 0}, 5)});
  ring.contours[1].hole = true;
  const TrackedSlice below = slice_at(0, {circle({0, 0}, 12)}), above = slice_at(16, {circle({0, 0}, 12)});
  const auto surfaces = morph({below, ring, above});
  CHECK(surfaces.notes.size() == 2);
  const MeshReport report = check_mesh(surfaces.mesh);
  CHECK(report.labels.at(1).components == 2);  // the outer surface and that of the hole
  for (const Eigen::Vector3f& p : surfaces.mesh.positions)
    if (radius_of(p) < 8 && p.z() > 1 && p.z() < 15) {
      CHECK(p.z() > 3.5F);
      CHECK(p.z() < 12.5F);
    }
}

TEST_CASE("metamorphosis: flat ends lie in the end slices, round ones half a slice distance beyond") {
  const auto slices = circles({10, 12, 10}, 6);
  const auto flat = heights(morph(slices, StackEnds::flat).mesh), round = heights(morph(slices, StackEnds::round).mesh);
  CHECK(flat.first == doctest::Approx(0).scale(kCell));
  CHECK(flat.second == doctest::Approx(12).epsilon(0.005));
  CHECK(round.first == doctest::Approx(-3).epsilon(0.1));
  CHECK(round.second == doctest::Approx(15).epsilon(0.02));
}

TEST_CASE("metamorphosis: labels that touch share one wall, and slices hold the labels that they show") {
  std::vector<TrackedSlice> slices;
  for (const double height : {0.0, 7.0, 14.0}) {
    const double wall = 0.3 * height - 2;
    TrackedSlice slice = slice_at(height, {rectangle({-10, -8}, {wall, 8})});
    add_loop(slice, rectangle({wall, -8}, {10, 8}), 2);
    slices.push_back(slice);
  }
  const IndexedMesh mesh = morph(slices).mesh;
  const MeshReport report = check_mesh(mesh);
  CHECK(count_self_intersections(mesh) == 0);
  REQUIRE(report.labels.size() == 3);
  CHECK(report.labels.at(1).volume_mm3 == doctest::Approx(16 * 14 * 10.1).epsilon(0.02));
  CHECK(report.labels.at(2).volume_mm3 == doctest::Approx(16 * 14 * 9.9).epsilon(0.02));
  double off_wall = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.label_front[t] == kOutside || mesh.label_back[t] == kOutside) continue;
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Eigen::Vector3d p = mesh.positions[v].cast<double>();
      if (std::abs(p.y()) > 5 || std::abs(p.z() - 7) > 6) continue;  // where it meets the outside it is rounded
      off_wall = std::max(off_wall, std::abs(p.x() - (0.3 * p.z() - 2)) / kCell);
    }
  }
  MESSAGE("the wall is at most ", off_wall, " cells off its plane");
  CHECK(off_wall < 0.1);
  CHECK(largest(contour_distances(slices, mesh)) < 0.5 * kCell);
}

TEST_CASE("metamorphosis: the number of threads changes no byte") {
  const auto slices = circles({10, 14, 9}, 5);
  const IndexedMesh one = morph(slices, StackEnds::round, 1).mesh, two = morph(slices, StackEnds::round, 2).mesh;
  REQUIRE(one.positions.size() == two.positions.size());
  CHECK(one.triangles == two.triangles);
  CHECK(std::memcmp(one.positions.data(), two.positions.data(), one.positions.size() * sizeof(Eigen::Vector3f)) == 0);
}
