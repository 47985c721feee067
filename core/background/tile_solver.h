#pragma once
// update:  NodeData, shares of the next coarser level -> [TILE] -> shares of one level
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/background/brick_table.h"

namespace sonoloft {

inline constexpr int kSweeps = 8;  ///< of every level; no more than kBrickEdge: results reach one brick far
inline constexpr float kDataStiffness = 16.0f;  ///< beta of the equation

/// One level of the cascade as the solver sees it.
struct LevelView {
  const BrickTable<NodeData>* data;
  const BrickTable<NodeShares>* coarser;  ///< at twice the spacing; null: start from the prior
  float screening;                        ///< (spacing / screening length)^2
  int rounding;                           ///< shares are rounded to multiples of it / kShareUnit
};

/// Runs the sweeps of one level on a box of bricks. A node's result is a function of the data and the coarser shares
/// within kSweeps nodes of it, the same bits in whatever tile it is computed. Threads: each its own solver.
class TileSolver {
 public:
  /// @param bricks  ends included
  void set_tile(const LevelView& level, const Eigen::AlignedBox3i& bricks);
  /// Labels that may have a share in the tile, ascending, without outside.
  [[nodiscard]] const std::vector<Label>& labels() const { return labels_; }
  void solve(Label label);
  /// Rounded shares of the label solved last. @return whether any is not 0
  bool store(const Eigen::Vector3i& brick, LabelRows<std::uint16_t>::Row& out) const;

 private:
  [[nodiscard]] std::size_t at(const Eigen::Vector3i& node) const {
    const Eigen::Vector3i p = node - region_.min();
    return static_cast<std::size_t>(p.x()) + stride_y_ * static_cast<std::size_t>(p.y()) +
           stride_z_ * static_cast<std::size_t>(p.z());
  }
  template <class Visit>
  void for_each_row(const Eigen::AlignedBox3i& box, Visit visit) const;
  void find_labels();
  void fill_diagonal();
  void gather_coarse(Label label);
  void push(Label label);
  void apply_data(Label label);
  void sweep(int margin, float relaxation);

  LevelView level_{};
  Eigen::AlignedBox3i region_, coarse_;  ///< nodes of the tile and kSweeps around it; coarser nodes around these
  std::size_t stride_y_ = 0, stride_z_ = 0;
  std::vector<Label> labels_;
  std::vector<float> inverse_;     ///< [region] 1 / (6 + screening + stiffness w), 0 beyond the lattice
  std::vector<float> source_;      ///< [region] stiffness w d of the label
  std::vector<float> now_, next_;  ///< [region]
  std::vector<float> coarse_shares_, along_x_, along_y_;
};

}  // namespace sonoloft
