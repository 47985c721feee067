#include "host/view/scene/brick_bytes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "host/view/scene/little_endian.h"

namespace sonoloft::view {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// The triangle as seen from outside of the material; none where it does not bound it.
std::optional<Triangle> seen_from_outside(const MeshChunk& chunk, std::size_t i, Label material) {
  const Triangle& t = chunk.triangles[i];
  if (chunk.label_back[i] == material) return t;
  if (chunk.label_front[i] == material) return Triangle{t[0], t[2], t[1]};
  return std::nullopt;
}

Eigen::Vector3f area_normal(const MeshChunk& chunk, const Triangle& t) {
  const Eigen::Vector3f& a = chunk.positions[t[0]];
  return (chunk.positions[t[1]] - a).cross(chunk.positions[t[2]] - a);
}

std::vector<Label> materials_of(const MeshChunk& chunk) {
  std::vector<Label> labels(chunk.label_front);
  labels.insert(labels.end(), chunk.label_back.begin(), chunk.label_back.end());
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  if (!labels.empty() && labels.front() == kOutside) labels.erase(labels.begin());
  return labels;
}

/// Writes the surfaces of a chunk, one material after the other.
class SurfaceWriter {
 public:
  SurfaceWriter(const MeshChunk& chunk, const Neighbours& around, const Confidence& sure)
      : chunk_(chunk), around_(around), sure_(sure) {
    for (std::uint32_t v = 0; v < chunk.vertex_keys.size(); ++v) by_key_.emplace(chunk.vertex_keys[v], v);
  }

  void append_surface(Label material, std::string& out) {
    collect(material);
    add_normals(material);
    const auto vertices = static_cast<std::uint32_t>(used_.size());
    for (const std::uint32_t number : {std::uint32_t{material}, vertices, static_cast<std::uint32_t>(indices_.size())})
      append(out, number);
    for (const std::uint32_t v : used_) append(out, std::span<const float>(chunk_.positions[v].data(), 3));
    for (const std::uint32_t v : used_) append_normal(v, out);
    append_distances(out);
    append(out, std::span<const std::uint32_t>(indices_));
  }

 private:
  void collect(Label material) {
    slot_.assign(chunk_.positions.size(), 0);
    used_.clear();
    indices_.clear();
    for (std::size_t i = 0; i < chunk_.triangles.size(); ++i) {
      const auto triangle = seen_from_outside(chunk_, i, material);
      if (!triangle) continue;
      for (const std::uint32_t v : *triangle) {
        if (slot_[v] == 0) {
          used_.push_back(v);
          slot_[v] = static_cast<std::uint32_t>(used_.size());
        }
        indices_.push_back(slot_[v] - 1);
      }
    }
  }

  /// Sums the triangles around every vertex, in the chunks beside this one too.
  void add_normals(Label material) {
    normals_.assign(chunk_.positions.size(), Eigen::Vector3f::Zero());
    for (const MeshChunk* beside : around_) {
      if (beside == nullptr) continue;
      for (std::size_t i = 0; i < beside->triangles.size(); ++i)
        if (const auto triangle = seen_from_outside(*beside, i, material)) add_normal(*beside, *triangle);
    }
  }

  void add_normal(const MeshChunk& chunk, const Triangle& triangle) {
    for (const std::uint32_t v : triangle) {
      if (&chunk == &chunk_) {
        normals_[v] += area_normal(chunk, triangle);
      } else if (const auto own = by_key_.find(chunk.vertex_keys[v]); own != by_key_.end()) {
        normals_[own->second] += area_normal(chunk, triangle);
      }
    }
  }

  void append_normal(std::uint32_t v, std::string& out) const {
    const Eigen::Vector3f n = normals_[v].stableNormalized();
    const auto part = [&](int axis) { return static_cast<std::int8_t>(std::lround(127 * n[axis])); };
    const float share = sure_.measured.empty() ? 1 : std::clamp(sure_.measured[v], 0.F, 1.F);
    const std::array bytes{part(0), part(1), part(2), static_cast<std::int8_t>(std::lround(127 * share))};
    append(out, std::span<const std::int8_t>(bytes));
  }

  void append_distances(std::string& out) const {
    std::vector<std::uint8_t> quarters((used_.size() + 3) / 4 * 4, 0);
    if (!sure_.distance_mm.empty())
      std::transform(used_.begin(), used_.end(), quarters.begin(), [&](std::uint32_t v) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(4 * sure_.distance_mm[v], 0.F, 255.F)));
      });
    append(out, std::span<const std::uint8_t>(quarters));
  }

  const MeshChunk& chunk_;
  const Neighbours& around_;
  const Confidence& sure_;
  std::unordered_map<std::uint64_t, std::uint32_t> by_key_;
  std::vector<std::uint32_t> slot_;  ///< [#V] index among those used + 1, or 0
  std::vector<std::uint32_t> used_;
  std::vector<std::uint32_t> indices_;
  std::vector<Eigen::Vector3f> normals_;  ///< [#V]
};

}  // namespace

void append_brick(const BrickCoord& coord, const MeshChunk* chunk, const Neighbours& around, const Confidence& sure,
                  std::string& out) {
  for (const std::int32_t c : {coord.x, coord.y, coord.z}) append(out, c);
  const std::vector<Label> materials = chunk == nullptr ? std::vector<Label>{} : materials_of(*chunk);
  append(out, static_cast<std::uint32_t>(materials.size()));
  if (chunk == nullptr) return;
  SurfaceWriter writer(*chunk, around, sure);
  for (const Label material : materials) writer.append_surface(material, out);
}

std::size_t faces_of(const MeshChunk& chunk) {
  std::size_t faces = 0;
  for (std::size_t i = 0; i < chunk.triangles.size(); ++i)
    faces += (chunk.label_front[i] == kOutside ? 0u : 1u) + (chunk.label_back[i] == kOutside ? 0u : 1u);
  return faces;
}

}  // namespace sonoloft::view
