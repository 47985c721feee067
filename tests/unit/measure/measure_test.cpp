#include "host/apps/measure/measure.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/mesh/solid_meshes.h"

using namespace sonoloft;
using namespace sonoloft::test;
using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;

double ball(double radius) {
  return 4.0 / 3.0 * kPi * radius * radius * radius;
}

/// The part of two balls of one radius that is common at a distance of their centres.
double lens(double radius, double distance) {
  return kPi * (4 * radius + distance) * std::pow(2 * radius - distance, 2) / 12;
}

template <class Rule>
LabelVolume volume(const std::array<std::uint32_t, 3>& dims, const Vector3d& spacing, const Vector3d& origin,
                   Rule label_at) {
  LabelVolume v{dims, spacing, origin, {}};
  for (std::uint32_t k = 0; k < dims[2]; ++k) {
    for (std::uint32_t j = 0; j < dims[1]; ++j) {
      for (std::uint32_t i = 0; i < dims[0]; ++i) {
        v.labels.push_back(label_at(Vector3d(origin + spacing.cwiseProduct(Vector3d(i, j, k)))));
      }
    }
  }
  return v;
}

/// A cheap scramble of a point's bits: labels with no order in space.
Label noise(const Vector3d& p, int labels) {
  auto h = static_cast<std::uint64_t>(std::llround(p.x() * 8 + p.y() * 8192 + p.z() * 8388608) + (1ll << 40));
  h = (h ^ (h >> 31)) * 0x9E3779B97F4A7C15ull;
  return static_cast<Label>((h >> 33) % static_cast<std::uint64_t>(labels));
}

}  // namespace

TEST_CASE("measure: two equal spheres a known distance apart overlap and differ as geometry says") {
  const double radius = 10, apart = 4;
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0.48, 0.6, 0.64)}) {
    const auto result =
        measure_against_mesh(sphere_mesh(apart * axis, radius, 5), sphere_mesh({0, 0, 0}, radius, 5), 2);
    REQUIRE(result);
    REQUIRE(result->overlaps.size() == 1);
    const double iou = lens(radius, apart) / (2 * ball(radius) - lens(radius, apart));
    const double dice = lens(radius, apart) / ball(radius);
    MESSAGE("IoU ", result->overlaps[0].iou(), " (", iou, "), Hausdorff ", result->surface.max_mm);
    CHECK(std::abs(result->overlaps[0].iou() - iou) < 5e-4);
    CHECK(std::abs(result->overlaps[0].dice() - dice) < 5e-4);
    CHECK(std::abs(result->overlaps[0].truth_mm3 / ball(radius) - 1) < 1e-3);
    CHECK(std::abs(result->surface.max_mm - apart) < 5e-3);
    // From a point at angle t to the shift: | sqrt(R^2 + 2 R d cos t + d^2) - R |, over the sphere's area.
    double mean = 0;
    for (int i = 0; i < 1000; ++i) {
      const double cosine = (i + 0.5) / 500 - 1;
      mean += std::abs(std::sqrt(radius * radius + 2 * radius * apart * cosine + apart * apart) - radius) / 1000;
    }
    CHECK(std::abs(result->surface.mean_mm - mean) < 2e-3);
    CHECK(std::abs(result->truth_diagonal_mm - 20 * std::sqrt(3.0)) < 0.05);
    CHECK(result->open_lines == 0);
  }
}

TEST_CASE("measure: a shifted box has the overlap of its overlap") {
  const auto result = measure_against_mesh(box_mesh({5, 2, 1}, {15, 12, 11}), box_mesh({0, 0, 0}, {10, 10, 10}), 1);
  REQUIRE(result);
  const double common = 5.0 * 8.0 * 9.0, iou = common / (2000 - common);
  MESSAGE("IoU ", result->overlaps[0].iou(), " (", iou, ")");
  CHECK(std::abs(result->overlaps[0].iou() - iou) < 2e-3);
  CHECK(std::abs(result->surface.max_mm - std::sqrt(25.0 + 4 + 1)) < 1e-5);
}

TEST_CASE("measure: nested labels are told apart") {
  const auto nested = [](double inner) {
    return together(sphere_mesh({3, -2, 1}, 10, 5, 0, 1), sphere_mesh({3, -2, 1}, inner, 5, 1, 7));
  };
  const auto result = measure_against_mesh(nested(5), nested(4), 2);
  REQUIRE(result);
  REQUIRE(result->overlaps.size() == 2);
  CHECK(result->overlaps[0].label == 1);
  CHECK(result->overlaps[1].label == 7);
  CHECK(std::abs(result->overlaps[0].iou() - (1000.0 - 125) / (1000 - 64)) < 1e-3);
  CHECK(std::abs(result->overlaps[1].iou() - 64.0 / 125) < 1e-3);
  CHECK(std::abs(result->distances[1].distance.mean_mm - 1) < 0.01);
  CHECK(std::abs(result->distances[1].distance.max_mm - 1) < 0.02);
  CHECK(std::abs(result->distances[0].distance.max_mm - 1) < 0.02);
  CHECK(result->distances[0].distance.mean_mm < 0.25);
}

TEST_CASE("measure: a label that one side lacks has no overlap and no finite distance") {
  const auto result = measure_against_mesh(sphere_mesh({0, 0, 0}, 5, 3, 0, 2), sphere_mesh({0, 0, 0}, 5, 3, 0, 3), 1);
  REQUIRE(result);
  REQUIRE(result->overlaps.size() == 2);
  CHECK(result->overlaps[0].iou() == 0);
  CHECK(result->overlaps[1].dice() == 0);
  CHECK(std::isinf(result->distances[0].distance.mean_mm));
  CHECK(result->surface.max_mm < 1e-6);
}

TEST_CASE("measure: distances of squares are those of their planes and of what hangs over") {
  const auto parallel = measure_against_mesh(square_mesh({0, 0, 3}, 10), square_mesh({0, 0, 0}, 10), 1);
  REQUIRE(parallel);
  CHECK(std::abs(parallel->surface.mean_mm - 3) < 1e-6);
  CHECK(std::abs(parallel->surface.max_mm - 3) < 1e-6);
  const auto larger = measure_against_mesh(square_mesh({0, 0, 0}, 4), square_mesh({0, 0, 0}, 10), 1);
  REQUIRE(larger);
  CHECK(std::abs(larger->surface.max_mm - 3 * std::sqrt(2.0)) < 1e-6);
}

TEST_CASE("measure: lines through vertices, edges and faces count once") {
  const LabelVolume truth = volume({10, 9, 8}, {1, 1, 1}, {0, 0, 0}, [](const Vector3d& p) -> Label {
    return ((p.array() >= 2).all() && (p.array() < 6).all()) ? 1 : 0;
  });
  const auto box = measure_against_volume(box_mesh({2, 2, 2}, {6, 6, 6}), truth, 1);
  REQUIRE(box);
  CHECK(box->open_lines == 0);
  CHECK(box->overlaps[0].mesh_mm3 == 64);
  CHECK(box->overlaps[0].iou() == 1);
  // An octahedron: all vertices and edges on lines.
  IndexedMesh octahedron = sphere_mesh({0, 0, 0}, 1, 0);
  octahedron.positions = {{4, 4, 1}, {4, 4, 7}, {1, 4, 4}, {4, 1, 4}, {7, 4, 4}, {4, 7, 4}};
  octahedron.triangles = {{1, 2, 3}, {1, 3, 4}, {1, 4, 5}, {1, 5, 2}, {0, 3, 2}, {0, 4, 3}, {0, 5, 4}, {0, 2, 5}};
  octahedron.label_front.resize(8);
  octahedron.label_back.resize(8);
  const auto result = measure_against_volume(octahedron, truth, 1);
  REQUIRE(result);
  CHECK(result->open_lines == 0);
  // Voxels with |x-4| + |y-4| + |z-4| < 3 are 25; of those at exactly 3 (38) the half-open rule takes some.
  MESSAGE("octahedron: ", result->overlaps[0].mesh_mm3, " voxels");
  CHECK(result->overlaps[0].mesh_mm3 >= 25);
  CHECK(result->overlaps[0].mesh_mm3 <= 25 + 38);
}

TEST_CASE("measure: the faces of voxels agree with their voxels exactly, even of label noise") {
  const LabelVolume truth =
      volume({23, 17, 19}, {0.5, 0.75, 1.25}, {-3, 40, 7.5}, [](const Vector3d& p) { return noise(p, 5); });
  const auto result = measure_against_volume(voxel_surface(truth), truth, 2);
  REQUIRE(result);
  REQUIRE(result->overlaps.size() == 4);
  for (const LabelOverlap& label : result->overlaps) {
    CHECK(label.iou() == 1);
    CHECK(label.truth_mm3 > 500);
  }
  CHECK(result->surface.max_mm < 1e-9);
  CHECK(result->open_lines == 0);
}

TEST_CASE("measure: a sphere agrees with its own voxels, and disagrees by a shift") {
  const auto truth = [](const Vector3d& shift) {
    return volume({60, 50, 40}, {0.5, 0.6, 0.75}, Vector3d(-15, -15, -15) + shift,
                  [&](const Vector3d& p) -> Label { return (p - shift).norm() < 12 ? 3 : 0; });
  };
  const IndexedMesh sphere = sphere_mesh({0, 0, 0}, 12, 5, 0, 3);
  const auto same = measure_against_volume(sphere, truth({0, 0, 0}), 2);
  REQUIRE(same);
  MESSAGE("IoU ", same->overlaps[0].iou(), ", mean ", same->surface.mean_mm, " mm, max ", same->surface.max_mm, " mm");
  CHECK(same->overlaps[0].iou() > 0.998);
  CHECK(same->surface.max_mm < 0.6);
  CHECK(same->surface.mean_mm < 0.25);
  for (const Vector3d& shift : {Vector3d(3, 0, 0), Vector3d(0, 0, 3)}) {
    const auto shifted = measure_against_volume(sphere, truth(shift), 2);
    REQUIRE(shifted);
    CHECK(std::abs(shifted->overlaps[0].dice() - lens(12, 3) / ball(12)) < 3e-3);
  }
}

TEST_CASE("measure: what reaches out of the volume counts against it") {
  const LabelVolume half = volume({40, 40, 20}, {1, 1, 1}, {-19.5, -19.5, 0.5},
                                  [](const Vector3d& p) -> Label { return p.norm() < 15 ? 1 : 0; });
  const auto result = measure_against_volume(sphere_mesh({0, 0, 0}, 15, 5), half, 1);
  REQUIRE(result);
  CHECK(std::abs(result->overlaps[0].iou() - 0.5) < 5e-3);
  CHECK(std::abs(result->overlaps[0].mesh_mm3 / (2 * result->overlaps[0].truth_mm3) - 1) < 5e-3);
}

TEST_CASE("measure: the result is the same bits with any number of threads, and far from the origin nearly the same") {
  const Vector3d far(1e5, -2e5, 5e4);
  const auto at = [](const Vector3d& o, int threads) {
    return measure_against_mesh(sphere_mesh(o + Vector3d(1, 2, 3), 40, 4), sphere_mesh(o, 42, 4), threads);
  };
  const auto one = at({0, 0, 0}, 1), three = at({0, 0, 0}, 3), away = at(far, 2);
  REQUIRE(one);
  REQUIRE(three);
  REQUIRE(away);
  CHECK(one->overlaps[0].common_mm3 == three->overlaps[0].common_mm3);
  CHECK(one->surface.mean_mm == three->surface.mean_mm);
  CHECK(one->surface.max_mm == three->surface.max_mm);
  CHECK(std::abs(one->overlaps[0].iou() - away->overlaps[0].iou()) < 2e-3);
  CHECK(std::abs(one->surface.max_mm - away->surface.max_mm) < 0.05);
}

TEST_CASE("measure: a mesh that does not close is reported") {
  IndexedMesh open = box_mesh({0, 0, 0}, {10, 10, 10});
  open.triangles.pop_back();
  open.label_front.pop_back();
  open.label_back.pop_back();
  const auto result = measure_against_mesh(open, box_mesh({0, 0, 0}, {10, 10, 10}), 1);
  REQUIRE(result);
  MESSAGE("open lines: ", result->open_lines);
  CHECK(result->open_lines > 100'000);  // half of one of the two sides that 513 x 513 lines pass
}

TEST_CASE("measure: bad input is refused with its reason") {
  const IndexedMesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  IndexedMesh nan = box;
  nan.positions[3].y() = std::numeric_limits<float>::quiet_NaN();
  const auto code = [](const auto& result) { return result ? 0 : static_cast<int>(result.error().code); };
  CHECK(code(measure_against_mesh({}, box, 1)) == int(ErrorCode::empty_input));
  CHECK(code(measure_against_mesh(box, {}, 1)) == int(ErrorCode::empty_input));
  CHECK(code(measure_against_mesh(nan, box, 1)) == int(ErrorCode::non_finite));
  CHECK(code(measure_against_mesh(box, nan, 1)) == int(ErrorCode::non_finite));
  LabelVolume truth{{2, 2, 2}, {1, 1, 1}, {0, 0, 0}, std::vector<Label>(8, 1)};
  CHECK(code(measure_against_volume(box, truth, 1)) == 0);
  truth.spacing_mm.y() = 0;
  CHECK(code(measure_against_volume(box, truth, 1)) == int(ErrorCode::invalid_argument));
  truth.spacing_mm = {1e-9, 1, 1};
  CHECK(code(measure_against_volume(box, truth, 1)) == int(ErrorCode::too_large));
  truth.spacing_mm = {1, 1, 1};
  truth.labels.pop_back();
  CHECK(code(measure_against_volume(box, truth, 1)) == int(ErrorCode::invalid_argument));
  truth.labels.assign(8, 0);
  CHECK(code(measure_against_volume(box, truth, 1)) == int(ErrorCode::empty_input));
  truth.dims = {0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF};
  CHECK(code(measure_against_volume(box, truth, 1)) == int(ErrorCode::invalid_argument));
}
