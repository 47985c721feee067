#include "core/mesh/drawing/chunk_buffer.h"

#include <cstring>

namespace sonoloft {
namespace {

bool same_content(const MeshChunk& a, const MeshChunk& b) {
  const std::size_t bytes = a.positions.size() * sizeof(Eigen::Vector3f);
  return a.vertex_keys == b.vertex_keys && a.triangles == b.triangles && a.label_front == b.label_front &&
         a.label_back == b.label_back && std::memcmp(a.positions.data(), b.positions.data(), bytes) == 0;
}

}  // namespace

void ChunkBuffer::start(const BrickCoord& coord) {
  chunk_.coord = coord;
  chunk_.positions.clear();
  chunk_.vertex_keys.clear();
  chunk_.triangles.clear();
  chunk_.label_front.clear();
  chunk_.label_back.clear();
  points_.clear();
  cell_slots_.fill(0);
  for (const std::size_t at : used_nodes_) node_slots_[at] = 0;
  used_nodes_.clear();
}

std::uint32_t ChunkBuffer::add_vertex(LocalPoint at, unsigned kind, const BrickPoint& point) {
  points_.push_back(point);
  chunk_.vertex_keys.push_back(vertex_key(chunk_.coord, at, kind));
  return static_cast<std::uint32_t>(points_.size() - 1);
}

std::uint32_t ChunkBuffer::add_cell_vertex(int place, const CellPoint& point) {
  const LocalPoint cell{place % kPlaces[1] - 1, place / kPlaces[1] % kPlaces[1] - 1, place / kPlaces[2] - 1};
  const std::uint32_t vertex = add_vertex(cell, kCellVertex, cell + point);
  cell_slots_[static_cast<std::size_t>(place)] = static_cast<std::uint16_t>(vertex + 1);
  return vertex;
}

std::shared_ptr<const MeshChunk> ChunkBuffer::finish(const LatticeFrame& frame,
                                                     const std::shared_ptr<const MeshChunk>& previous) {
  if (chunk_.triangles.empty()) return nullptr;
  chunk_.positions.reserve(points_.size());
  for (const BrickPoint& point : points_) chunk_.positions.push_back(to_mm(frame, chunk_.coord, point));
  if (previous && same_content(*previous, chunk_)) return previous;
  return std::make_shared<const MeshChunk>(chunk_);
}

std::uint32_t ChunkBuffer::collapsed_triangles() const {
  const auto collapsed = [&](const std::array<std::uint32_t, 3>& t) {
    const auto& p = chunk_.positions;
    return p[t[0]] == p[t[1]] || p[t[1]] == p[t[2]] || p[t[2]] == p[t[0]];
  };
  return static_cast<std::uint32_t>(std::count_if(chunk_.triangles.begin(), chunk_.triangles.end(), collapsed));
}

}  // namespace sonoloft
