#include "host/view/split_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

namespace sonoloft::view {
namespace {

constexpr double kTrianglesPerChunk = 1000;

MeshChunk chunk_of(const IndexedMesh& mesh, const BrickCoord& coord, std::span<const std::size_t> triangles) {
  MeshChunk chunk;
  chunk.coord = coord;
  std::unordered_map<std::uint32_t, std::uint32_t> local;
  const auto vertex = [&](std::uint32_t v) {
    const auto [at, fresh] = local.try_emplace(v, static_cast<std::uint32_t>(chunk.positions.size()));
    if (fresh) {
      chunk.positions.push_back(mesh.positions[v]);
      chunk.vertex_keys.push_back(v);
    }
    return at->second;
  };
  for (const std::size_t t : triangles) {
    const auto& corners = mesh.triangles[t];
    const std::uint32_t a = vertex(corners[0]), b = vertex(corners[1]), c = vertex(corners[2]);
    chunk.triangles.push_back({a, b, c});
    chunk.label_front.push_back(mesh.label_front[t]);
    chunk.label_back.push_back(mesh.label_back[t]);
  }
  return chunk;
}

}  // namespace

MeshSnapshot split(const IndexedMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p);
  // A surface of n chunks fills about n of the side^3 places when side^2 is about n.
  const double side = std::max(1.0, std::sqrt(static_cast<double>(mesh.triangles.size()) / kTrianglesPerChunk));
  const float step_mm = box.isEmpty() ? 1 : std::max(box.sizes().maxCoeff() / static_cast<float>(side), 1e-6F);
  std::map<BrickCoord, std::vector<std::size_t>> places;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3i at =
        ((mesh.positions[mesh.triangles[t][0]] - box.min()) / step_mm).array().floor().matrix().cast<int>();
    places[{at.x(), at.y(), at.z()}].push_back(t);
  }
  MeshSnapshot snapshot;
  for (const auto& [coord, triangles] : places)
    snapshot.chunks.push_back(std::make_shared<const MeshChunk>(chunk_of(mesh, coord, triangles)));
  return snapshot;
}

}  // namespace sonoloft::view
