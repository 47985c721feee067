#include "core/voxels/voxelize.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "host/apps/measure/measure.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/mesh_labels.h"
#include "tests/support/mesh/solid_meshes.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

LabelVolume voxels_of(const IndexedMesh& mesh, double voxel_mm, int threads = 2) {
  auto volume = voxelize(mesh, voxel_mm, threads);
  REQUIRE_MESSAGE(volume, (volume ? "" : volume.error().message));
  CHECK(volume->labels.size() == std::size_t{volume->dims[0]} * volume->dims[1] * volume->dims[2]);
  return std::move(*volume);
}

/// Of the voxel whose centre is nearest.
Label label_at(const LabelVolume& volume, const Eigen::Vector3d& point_mm) {
  const Eigen::Array3d steps = ((point_mm - volume.origin_mm).array() / volume.spacing_mm.array()).round();
  const auto at = steps.cast<std::size_t>();
  return volume.labels.at(at.x() + volume.dims[0] * (at.y() + volume.dims[1] * at.z()));
}

std::map<Label, std::size_t> counts_of(const LabelVolume& volume) {
  std::map<Label, std::size_t> counts;
  for (const Label label : volume.labels) ++counts[label];
  return counts;
}

/// Labels 0 to 3 in blobs of two voxels, outside on all sides.
LabelVolume label_noise(double voxel_mm) {
  LabelVolume volume{{25, 17, 21}, Eigen::Vector3d::Constant(voxel_mm), Eigen::Vector3d(-3.5, 9.5, 0.5) * voxel_mm, {}};
  std::mt19937 random(1);
  std::vector<Label> blobs(13 * 9 * 11);
  for (Label& blob : blobs) blob = static_cast<Label>(random() % 4);
  for (std::size_t z = 0; z < 21; ++z)
    for (std::size_t y = 0; y < 17; ++y)
      for (std::size_t x = 0; x < 25; ++x) {
        const bool rim = x % 24 == 0 || y % 16 == 0 || z % 20 == 0;
        volume.labels.push_back(rim ? kOutside : blobs[x / 2 + 13 * (y / 2 + 9 * (z / 2))]);
      }
  return volume;
}

}  // namespace

TEST_CASE("voxelize: a box has the voxels whose centres it holds, and one layer of outside around") {
  const LabelVolume volume = voxels_of(box_mesh({-2, 3, 10}, {4, 5, 13}, 0, 9), 1);
  CHECK(volume.dims == std::array<std::uint32_t, 3>{9, 5, 6});  // a face on a voxel's face: the one above is taken too
  CHECK(volume.spacing_mm == Eigen::Vector3d(1, 1, 1));
  CHECK(volume.origin_mm == Eigen::Vector3d(-2.5, 2.5, 9.5));
  CHECK(counts_of(volume)[9] == 6 * 2 * 3);
  CHECK(label_at(volume, {-1.5, 3.5, 10.5}) == 9);
  CHECK(label_at(volume, {3.5, 4.5, 12.5}) == 9);
  CHECK(label_at(volume, {-2.5, 3.5, 10.5}) == kOutside);
  CHECK(label_at(volume, {4.5, 4.5, 12.5}) == kOutside);
}

TEST_CASE("voxelize: the surface of voxels gives the voxels back, even of label noise") {
  const LabelVolume noise = label_noise(0.75);
  const LabelVolume volume = voxels_of(voxel_surface(noise), 0.75);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < noise.labels.size(); ++i) {
    const std::size_t x = i % 25, y = i / 25 % 17, z = i / 25 / 17;
    const Eigen::Vector3d steps(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    const Eigen::Vector3d point = noise.origin_mm + 0.75 * steps;
    const bool within = ((point - volume.origin_mm).array() > -0.1).all() && x < 24 && y < 16 && z < 20;
    if (within) wrong += label_at(volume, point) != noise.labels[i];
  }
  CHECK(wrong == 0);
  auto wanted = counts_of(noise), got = counts_of(volume);
  CHECK(wanted.size() == 4);
  wanted.erase(kOutside), got.erase(kOutside);
  CHECK(got == wanted);
}

TEST_CASE("voxelize: volumes are those of the mesh") {
  const IndexedMesh shell =
      together(sphere_mesh({3.1, -7.3, 11.4}, 20, 5, 0, 1), sphere_mesh({5.2, -7.1, 12.3}, 9, 5, 1, 2));
  const MeshReport exact = check_mesh(shell);
  for (const double voxel_mm : {1.0, 0.5}) {
    const LabelVolume volume = voxels_of(shell, voxel_mm);
    for (const Label label : {Label{1}, Label{2}}) {
      const double voxels_mm3 = static_cast<double>(counts_of(volume)[label]) * std::pow(voxel_mm, 3);
      const double error = voxels_mm3 / exact.labels.at(label).volume_mm3 - 1;
      MESSAGE("voxels of ", voxel_mm, " mm, label ", label, ": off by ", 100 * error, " %");
      CHECK(std::abs(error) < 0.01);
    }
  }
}

TEST_CASE("voxelize: every voxel has the label that a ray from its centre meets first") {
  const IndexedMesh organ =
      together(sphere_mesh({3.1, -7.3, 11.4}, 10, 3, 0, 1), sphere_mesh({5.2, -7.1, 12.3}, 5, 3, 1, 2));
  const LabelVolume volume = voxels_of(organ, 0.3);
  const MeshLabels rays(organ);
  std::size_t wrong = 0, i = 0;
  for (std::uint32_t z = 0; z < volume.dims[2]; ++z)
    for (std::uint32_t y = 0; y < volume.dims[1]; ++y)
      for (std::uint32_t x = 0; x < volume.dims[0]; ++x, ++i)
        wrong += rays.at(volume.origin_mm + 0.3 * Eigen::Vector3d(x, y, z)) != volume.labels[i];
  MESSAGE(wrong, " of ", i, " differ");
  CHECK(wrong <= 2);  // rays are of floats: a centre may lie within their rounding of the surface
}

TEST_CASE("voxelize: lines through vertices and edges count once, and not where they only touch") {
  // Half a voxel off, all vertices, edges and faces of the box lie on lines of centres.
  const LabelVolume on_lines = voxels_of(box_mesh({0.5, 0.5, 0.5}, {4.5, 4.5, 4.5}), 1);
  CHECK(counts_of(on_lines)[1] == 4 * 4 * 4);
  // An octahedron with its tips on lines.
  IndexedMesh octahedron;
  octahedron.positions = {{5.5f, 0.5f, 0.5f},  {-4.5f, 0.5f, 0.5f}, {0.5f, 5.5f, 0.5f},
                          {0.5f, -4.5f, 0.5f}, {0.5f, 0.5f, 5.5f},  {0.5f, 0.5f, -4.5f}};
  for (std::uint32_t i = 0; i < 8; ++i) {
    std::array<std::uint32_t, 3> t{i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2 & 1)};
    if (std::popcount(i) % 2 == 1) std::swap(t[1], t[2]);
    octahedron.triangles.push_back(t);
  }
  octahedron.label_front.assign(8, kOutside);
  octahedron.label_back.assign(8, 1);
  const std::size_t voxels = counts_of(voxels_of(octahedron, 1))[1];
  MESSAGE(voxels, " voxels in an octahedron of ", 4.0 / 3 * 125);
  CHECK(voxels >= 129);  // centres strictly inside
  CHECK(voxels <= 231);  // and on its border
}

TEST_CASE("voxelize: the same voxels with any number of threads") {
  const IndexedMesh mesh = together(sphere_mesh({0, 0, 0}, 10, 4, 0, 3), sphere_mesh({1, 2, 3}, 4, 3, 3, 700));
  const LabelVolume one = voxels_of(mesh, 0.4, 1), many = voxels_of(mesh, 0.4, 5);
  CHECK(one.dims == many.dims);
  CHECK(one.labels == many.labels);
  CHECK(counts_of(one).size() == 3);
}

TEST_CASE("voxelize: volumes of one space fit on each other whatever is in it") {
  const LabelVolume small = voxels_of(sphere_mesh({0.3, 0.1, 0.2}, 5, 2), 0.7);
  const LabelVolume large = voxels_of(sphere_mesh({-31, 8, 15.55}, 9, 2), 0.7);
  const Eigen::Array3d steps = ((large.origin_mm - small.origin_mm) / 0.7).array();
  CHECK((steps - steps.round()).abs().maxCoeff() < 1e-12);
}

TEST_CASE("voxelize: where spheres overlap it is the smaller of their labels") {
  const LabelVolume volume =
      voxels_of(together(sphere_mesh({0, 0, 0}, 10, 3, 0, 5), sphere_mesh({8, 0, 0}, 10, 3, 0, 2)), 1);
  CHECK(label_at(volume, {-5.5, 0.5, 0.5}) == 5);
  CHECK(label_at(volume, {4.5, 0.5, 0.5}) == 2);
  CHECK(label_at(volume, {13.5, 0.5, 0.5}) == 2);
}

TEST_CASE("voxelize: bad input is refused with its reason") {
  IndexedMesh box = box_mesh({0, 0, 0}, {10, 10, 10});
  const auto code = [](const IndexedMesh& mesh, double voxel_mm) {
    const auto volume = voxelize(mesh, voxel_mm, 1);
    return volume ? std::string("none") : std::string(name(volume.error().code));
  };
  CHECK(code(box, 1) == "none");
  CHECK(code(IndexedMesh{}, 1) == "empty_input");
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    CHECK(code(box, bad) == "invalid_argument");
  CHECK(code(box, 0.001) == "too_large");  // 10000 a side
  CHECK(code(box, 0.01) == "too_large");   // 1000 a side
  CHECK(code(box, 1e-300) == "too_large");
  CHECK(code(box_mesh({3e37, 0, 0}, {3e37, 10, 10}), 1) == "too_large");
  CHECK(code(box, 1e9) == "none");
  IndexedMesh open = box;
  open.triangles.pop_back(), open.label_front.pop_back(), open.label_back.pop_back();
  CHECK(code(open, 1) == "bad_contour");
  box.positions[3].x() = std::nanf("");
  CHECK(code(box, 1) == "non_finite");
}
