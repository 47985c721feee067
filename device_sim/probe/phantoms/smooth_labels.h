#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "device_sim/probe/phantom.h"

namespace sonoloft::device_sim {

/// A grid of labels blurred into shares: at every point the share of a label is its voxels' Gaussian mean, and the
/// label with the largest share holds the point. Kept in bricks of 8^3 voxels; only those near borders hold numbers.
/// Frame: voxels; the centre of voxel (i, j, k) is (i, j, k). Threads: const members may run together.
class SmoothLabels {
 public:
  SmoothLabels() = default;
  /// @param labels       [dims.x * dims.y * dims.z] x fastest; read only during the call; outside all around
  /// @param sigma_voxel  0 < sigma <= kMaxSigmaVoxel along each axis
  SmoothLabels(const Eigen::Vector3i& dims, const Eigen::Vector3d& sigma_voxel, std::span<const Label> labels);

  /// Of equal shares the smaller label's counts. @cost O(labels near the point)
  [[nodiscard]] Label label_at(const Eigen::Vector3d& point_voxel) const;

  /// Three of them fit into a brick, which is how far the blur looks.
  static constexpr double kMaxSigmaVoxel = 7.0 / 3;

 private:
  static constexpr int kEdge = 8;           ///< voxels along a brick
  static constexpr int kNodes = kEdge + 1;  ///< shares along a brick, both ends included
  /// Uniform: one label. Mixed: shares of `count` labels.
  struct Brick {
    std::uint32_t first_share = 0;    ///< into shares_
    std::uint32_t first_palette = 0;  ///< into palette_
    std::uint16_t count = 1;          ///< labels; 1 is uniform
    Label uniform = kOutside;
  };
  /// The voxels that the shares of one brick depend on.
  struct Block {
    std::array<int, 3> reach;                   ///< voxels beyond the brick, along each axis
    std::array<int, 3> size;                    ///< kNodes + 2 reach
    std::vector<Label> labels;                  ///< x fastest
    std::array<std::vector<float>, 3> weights;  ///< [2 reach + 1] of the blur along each axis, sum 1
    std::vector<float> z_done, y_done;          ///< room for the passes
  };

  [[nodiscard]] std::vector<std::uint32_t> summarise(const Eigen::Vector3i& dims, std::span<const Label> labels) const;
  [[nodiscard]] bool near_border(int x, int y, int z, const std::vector<std::uint32_t>& summary) const;
  void blur_brick(Brick& brick, Block& block);
  void add_shares(Label label, Block& block);

  std::array<int, 3> brick_dims_{};    ///< one brick of margin all around: brick (1, 1, 1) begins at voxel (0, 0, 0)
  std::vector<Brick> bricks_;          ///< x fastest
  std::vector<Label> palette_;         ///< ascending within a brick
  std::vector<std::uint16_t> shares_;  ///< [count][kNodes^3] of each mixed brick; 65535 is all
};

}  // namespace sonoloft::device_sim
