#include "tests/support/mesh/solid_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace sonoloft::test {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

IndexedMesh with_labels(std::vector<Eigen::Vector3f> positions, Triangles triangles, Label front, Label back) {
  IndexedMesh mesh{std::move(positions), std::move(triangles), {}, {}};
  mesh.label_front.assign(mesh.triangles.size(), front);
  mesh.label_back.assign(mesh.triangles.size(), back);
  return mesh;
}

/// Cuts each triangle into four; new vertices go onto the unit sphere.
void subdivide(std::vector<Eigen::Vector3d>& points, Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [place, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
    if (fresh) points.push_back((points[a] + points[b]).normalized());
    return place->second;
  };
  Triangles finer;
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  triangles = std::move(finer);
}

}  // namespace

IndexedMesh sphere_mesh(const Eigen::Vector3d& center_mm, double radius_mm, int levels, Label front, Label back) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  std::vector<Eigen::Vector3d> points{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                      {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (auto& p : points) p.normalize();
  Triangles triangles{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) subdivide(points, triangles);
  std::vector<Eigen::Vector3f> positions;
  for (const auto& p : points) positions.emplace_back((center_mm + radius_mm * p).cast<float>());
  return with_labels(std::move(positions), std::move(triangles), front, back);
}

IndexedMesh box_mesh(const Eigen::Vector3d& low_mm, const Eigen::Vector3d& high_mm, Label front, Label back) {
  std::vector<Eigen::Vector3f> positions;
  for (int i = 0; i < 8; ++i) {
    positions.emplace_back(Eigen::Vector3d((i & 1) != 0 ? high_mm.x() : low_mm.x(),
                                           (i & 2) != 0 ? high_mm.y() : low_mm.y(),
                                           (i & 4) != 0 ? high_mm.z() : low_mm.z())
                               .cast<float>());
  }
  return with_labels(std::move(positions),
                     {{0, 2, 3},
                      {0, 3, 1},
                      {4, 5, 7},
                      {4, 7, 6},
                      {0, 1, 5},
                      {0, 5, 4},
                      {2, 6, 7},
                      {2, 7, 3},
                      {0, 4, 6},
                      {0, 6, 2},
                      {1, 3, 7},
                      {1, 7, 5}},
                     front, back);
}

IndexedMesh square_mesh(const Eigen::Vector3d& center_mm, double side_mm, Label front, Label back) {
  std::vector<Eigen::Vector3f> positions;
  for (const auto& [x, y] : {std::pair(-0.5, -0.5), std::pair(0.5, -0.5), std::pair(0.5, 0.5), std::pair(-0.5, 0.5)}) {
    positions.emplace_back((center_mm + side_mm * Eigen::Vector3d(x, y, 0)).cast<float>());
  }
  return with_labels(std::move(positions), {{0, 1, 2}, {0, 2, 3}}, front, back);
}

IndexedMesh together(IndexedMesh one, const IndexedMesh& other) {
  const auto shift = static_cast<std::uint32_t>(one.positions.size());
  one.positions.insert(one.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) one.triangles.push_back({a + shift, b + shift, c + shift});
  one.label_front.insert(one.label_front.end(), other.label_front.begin(), other.label_front.end());
  one.label_back.insert(one.label_back.end(), other.label_back.begin(), other.label_back.end());
  return one;
}

}  // namespace sonoloft::test
