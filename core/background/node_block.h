#pragma once
// shares, local, distance:  points, bricks -> [BLOCK OF NODES] -> a number at every point
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/background/brick_table.h"

namespace sonoloft {

/// Where the nodes stand: node i at  origin + spacing * (i + 1/2), reference frame, mm.
struct NodeLattice {
  Eigen::Vector3d origin_mm;
  double spacing_mm;

  /// In steps between nodes; whole numbers are nodes.
  [[nodiscard]] Eigen::Vector3d steps(const Eigen::Vector3d& point_mm) const {
    return ((point_mm - origin_mm) / spacing_mm).array() - 0.5;
  }
  /// The nodes whose values reach into a box.
  [[nodiscard]] Eigen::AlignedBox3i nodes_around(const Eigen::AlignedBox3d& box_mm) const {
    return {steps(box_mm.min()).array().floor().cast<int>(), steps(box_mm.max()).array().floor().cast<int>() + 1};
  }
};

/// Points and the nodes around them, gathered into plain arrays. Few enough nodes to stay in a cache.
class NodeBlock {
 public:
  /// @param grown_by  nodes more on every side
  NodeBlock(const NodeLattice& lattice, std::span<const Eigen::Vector3d> points_mm, int grown_by);

  [[nodiscard]] const Eigen::AlignedBox3i& nodes() const { return nodes_; }  ///< ends included
  [[nodiscard]] Eigen::AlignedBox3i bricks() const { return {brick_of(nodes_.min()), brick_of(nodes_.max())}; }

  void clear() { value_.assign(static_cast<std::size_t>((nodes_.sizes().array() + 1).prod()), 0.0f); }
  /// Takes over the nodes of one brick; those that nobody sets are 0.
  template <class T>
  void set(const Eigen::Vector3i& brick, const std::array<T, kBrickNodes>& row) {
    const Eigen::AlignedBox3i box = nodes_of(brick).intersection(nodes_);
    for (int z = box.min().z(); z <= box.max().z(); ++z)
      for (int y = box.min().y(); y <= box.max().y(); ++y) {
        const T* from = row.data() + node_index(box.min().x(), y, z);
        float* to = value_.data() + at({box.min().x(), y, z});
        for (int x = box.min().x(); x <= box.max().x(); ++x) *to++ = static_cast<float>(*from++);
      }
  }
  [[nodiscard]] std::vector<float>& values() { return value_; }  ///< [nodes] x fastest

  /// Trilinear; a constant comes out as it is. @param out [#P]
  void interpolate(std::span<float> out) const;

 private:
  [[nodiscard]] std::size_t at(const Eigen::Vector3i& node) const {
    const Eigen::Vector3i p = node - nodes_.min();
    return static_cast<std::size_t>(p.x()) + stride_y_ * static_cast<std::size_t>(p.y()) +
           stride_z_ * static_cast<std::size_t>(p.z());
  }

  struct Place {
    std::uint32_t node;  ///< the lowest of the eight
    float x, y, z;       ///< 0..1 from there
  };
  Eigen::AlignedBox3i nodes_;
  std::size_t stride_y_ = 0, stride_z_ = 0;
  std::vector<Place> places_;  ///< [#P]
  std::vector<float> value_;
};

/// Calls visit(first, block) for pieces of the points [first, ...) that lie so near each other that a block holds them.
template <class Visit>
void for_each_block(const NodeLattice& lattice, std::span<const Eigen::Vector3d> points_mm, int grown_by, Visit visit,
                    std::size_t first = 0) {
  if (points_mm.empty()) return;
  constexpr double kLargest = 1 << 15;  // nodes
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points_mm) box.extend(p);
  const auto edges = box.sizes().array() / lattice.spacing_mm + 2.0 + 2.0 * grown_by;
  if (points_mm.size() == 1 || edges.prod() <= kLargest) {
    NodeBlock block(lattice, points_mm, grown_by);
    visit(first, block);
    return;
  }
  const std::size_t half = points_mm.size() / 2;
  for_each_block(lattice, points_mm.first(half), grown_by, visit, first);
  for_each_block(lattice, points_mm.subspan(half), grown_by, visit, first + half);
}

}  // namespace sonoloft
