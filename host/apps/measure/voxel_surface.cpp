#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/apps/measure/measure.h"

namespace sonoloft {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// Walks the volume upwards and keeps the vertices of two layers of voxel corners only.
class VoxelSurface {
 public:
  explicit VoxelSurface(const LabelVolume& volume)
      : volume_(volume), dims_(int(volume.dims[0]), int(volume.dims[1]), int(volume.dims[2])) {
    for (auto& layer : layers_) layer.assign(std::size_t(dims_.x() + 1) * std::size_t(dims_.y() + 1), kNone);
  }

  IndexedMesh build() {
    const Eigen::Vector3i& n = dims_;
    for (int k = 0; k <= n.z(); ++k) {
      for (int j = 0; j <= n.y(); ++j) {
        for (int i = 0; i <= n.x(); ++i) faces_of({i, j, k});
      }
      auto& passed = layers_[std::size_t(k) % 2];
      std::fill(passed.begin(), passed.end(), kNone);
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] Label label(const Eigen::Vector3i& v) const {
    if ((v.array() < 0).any() || (v.array() >= dims_.array()).any()) return kOutside;
    return volume_.labels[std::size_t(v.x()) +
                          std::size_t(dims_.x()) * (std::size_t(v.y()) + std::size_t(dims_.y()) * std::size_t(v.z()))];
  }

  /// The three faces between a voxel and its lower neighbours.
  void faces_of(const Eigen::Vector3i& voxel) {
    const Label above = label(voxel);
    for (int axis = 0; axis < 3; ++axis) {
      const Label below = label(voxel - Eigen::Vector3i::Unit(axis));
      if (above == below) continue;
      const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3), v = Eigen::Vector3i::Unit((axis + 2) % 3);
      std::array corners{vertex(voxel), vertex(voxel + u), vertex(voxel + u + v), vertex(voxel + v)};
      // Counter-clockwise seen from above, so the normal points up; the front is the smaller label.
      if (above > below) std::swap(corners[1], corners[3]);
      add(corners[0], corners[1], corners[2], std::min(above, below), std::max(above, below));
      add(corners[0], corners[2], corners[3], std::min(above, below), std::max(above, below));
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, Label front, Label back) {
    mesh_.triangles.push_back({a, b, c});
    mesh_.label_front.push_back(front);
    mesh_.label_back.push_back(back);
  }

  /// The lower corner of a voxel.
  std::uint32_t vertex(const Eigen::Vector3i& corner) {
    std::uint32_t& index = layers_[std::size_t(corner.z()) % 2]
                                  [std::size_t(corner.x()) + std::size_t(dims_.x() + 1) * std::size_t(corner.y())];
    if (index == kNone) {
      index = static_cast<std::uint32_t>(mesh_.positions.size());
      const Eigen::Vector3d steps = corner.cast<double>().array() - 0.5;
      mesh_.positions.emplace_back((volume_.origin_mm + steps.cwiseProduct(volume_.spacing_mm)).cast<float>());
    }
    return index;
  }

  const LabelVolume& volume_;
  Eigen::Vector3i dims_;
  std::array<std::vector<std::uint32_t>, 2> layers_;
  IndexedMesh mesh_;
};

}  // namespace

IndexedMesh voxel_surface(const LabelVolume& volume) {
  return VoxelSurface(volume).build();
}

}  // namespace sonoloft
