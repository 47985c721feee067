#include "host/apps/measure/distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/slice/parallel.h"
#include "host/apps/measure/mesh_tree.h"

namespace sonoloft {
namespace {

constexpr std::size_t kSamples = 100'000;
constexpr std::size_t kBlock = 1024;  // fixed, so that the order of summation is

/// Points spread evenly over the area; in the square of a triangle's two parameters they follow the R2 sequence
/// (Roberts 2018), folded.
std::vector<Eigen::Vector3d> samples_of(const IndexedMesh& mesh) {
  std::vector<double> area_up_to(mesh.triangles.size());
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = corners(mesh, t);
    area_up_to[t] = total += 0.5 * (b - a).cross(c - a).norm();
  }
  std::vector<Eigen::Vector3d> samples(kSamples);
  for (std::size_t s = 0, t = 0; s < kSamples; ++s) {
    const double place = (static_cast<double>(s) + 0.5) / static_cast<double>(kSamples) * total;
    while (t + 1 < area_up_to.size() && area_up_to[t] < place) ++t;
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(s), 1.0);
    double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(s), 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto [a, b, c] = corners(mesh, t);
    samples[s] = a + u * (b - a) + v * (c - a);
  }
  return samples;
}

std::vector<Eigen::Vector3d> vertices_of(const IndexedMesh& mesh) {
  std::vector<bool> used(mesh.positions.size());
  for (const auto& t : mesh.triangles) used[t[0]] = used[t[1]] = used[t[2]] = true;
  std::vector<Eigen::Vector3d> vertices;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) vertices.push_back(mesh.positions[v].cast<double>());
  }
  return vertices;
}

SurfaceDistance distance_of(const std::vector<Eigen::Vector3d>& points, const MeshTree& surface, int threads) {
  std::vector<SurfaceDistance> blocks((points.size() + kBlock - 1) / kBlock, SurfaceDistance{0, 0});
  parallel_for(blocks.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t block = first; block < last; ++block) {
      double bound = std::numeric_limits<double>::infinity();
      for (std::size_t i = block * kBlock; i < std::min(points.size(), (block + 1) * kBlock); ++i) {
        // Neighbours in the list are neighbours in space, mostly: the last distance bounds the next.
        if (i > block * kBlock) bound += (points[i] - points[i - 1]).norm();
        bound = surface.nearest(points[i], bound).distance_mm;
        blocks[block].mean_mm += bound;
        blocks[block].max_mm = std::max(blocks[block].max_mm, bound);
      }
    }
  });
  SurfaceDistance all{0, 0};
  for (const SurfaceDistance& block : blocks) {
    all.mean_mm += block.mean_mm;
    all.max_mm = std::max(all.max_mm, block.max_mm);
  }
  all.mean_mm /= static_cast<double>(points.size());
  return all;
}

/// From `from` to `to`.
SurfaceDistance one_sided(const IndexedMesh& from, const MeshTree& to, int threads) {
  const SurfaceDistance area = distance_of(samples_of(from), to, threads);
  const SurfaceDistance vertices = distance_of(vertices_of(from), to, threads);
  return {area.mean_mm, std::max(area.max_mm, vertices.max_mm)};
}

}  // namespace

SurfaceDistance surface_distance(const IndexedMesh& mesh, const IndexedMesh& truth, int threads) {
  if (mesh.triangles.empty() || truth.triangles.empty()) {
    return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  const SurfaceDistance there = one_sided(mesh, MeshTree(truth), threads);
  const SurfaceDistance back = one_sided(truth, MeshTree(mesh), threads);
  return {0.5 * (there.mean_mm + back.mean_mm), std::max(there.max_mm, back.max_mm)};
}

IndexedMesh triangles_of(const IndexedMesh& mesh, Label label) {
  IndexedMesh part;
  part.positions = mesh.positions;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.label_front[t] != label && mesh.label_back[t] != label) continue;
    part.triangles.push_back(mesh.triangles[t]);
    part.label_front.push_back(mesh.label_front[t]);
    part.label_back.push_back(mesh.label_back[t]);
  }
  return part;
}

}  // namespace sonoloft
