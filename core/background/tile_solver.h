#pragma once
// update:  NodeData, shares of the pass before -> [TILE] -> shares of one pass
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/background/brick_table.h"

namespace sonoloft {

inline constexpr int kSweeps = 4;               ///< of one pass, as far as its results reach; even
inline constexpr float kDataStiffness = 16.0f;  ///< beta of the equation

/// One pass of the cascade as the solver sees it. Every level has two, which share eight sweeps: the first starts from
/// the next coarser level, the second from the first.
struct PassView {
  const BrickTable<NodeData>* data;
  const BrickTable<NodeShares>* before;  ///< what the pass starts from; null: the prior
  bool from_coarser;                     ///< `before` has twice the spacing
  float screening;                       ///< (spacing / screening length)^2
};

/// Runs the sweeps of one pass on a box of bricks. A node's result is a function of the data and the shares started
/// from within kSweeps nodes of it, the same bits in whatever tile it is computed. Threads: each its own solver.
class TileSolver {
 public:
  /// @param bricks  ends included
  void set_tile(const PassView& pass, const Eigen::AlignedBox3i& bricks);
  /// Labels that may have a share in the tile, ascending, without outside.
  [[nodiscard]] const std::vector<Label>& labels() const { return labels_; }
  void solve(Label label);
  /// Shares of the label solved last, rounded. @return whether any is not 0
  template <class Round>
  bool store(const Eigen::Vector3i& brick, LabelRows<std::uint16_t>::Row& out, Round round) const {
    int any = 0;
    for_each_row(nodes_of(brick), [&](const Eigen::Vector3i& node, std::size_t length) {
      const float* from = &now_[at(node)];
      std::uint16_t* to = out.data() + node_index(node.x(), node.y(), node.z());
      for (std::size_t i = 0; i < length; ++i) any |= to[i] = round(from[i]);
    });
    return any != 0;
  }

 private:
  [[nodiscard]] std::size_t at(const Eigen::Vector3i& node) const {
    const Eigen::Vector3i p = node - region_.min();
    return static_cast<std::size_t>(p.x()) + stride_y_ * static_cast<std::size_t>(p.y()) +
           stride_z_ * static_cast<std::size_t>(p.z());
  }
  /// Calls visit(first node, length) for the rows of a box along x.
  template <class Visit>
  static void for_each_row(const Eigen::AlignedBox3i& box, Visit visit) {
    if (box.isEmpty()) return;
    const auto length = static_cast<std::size_t>(box.sizes().x() + 1);
    for (int z = box.min().z(); z <= box.max().z(); ++z)
      for (int y = box.min().y(); y <= box.max().y(); ++y) visit(Eigen::Vector3i(box.min().x(), y, z), length);
  }
  void find_labels();
  void fill_diagonal();
  [[nodiscard]] bool first_of_level() const { return pass_.from_coarser || pass_.before == nullptr; }
  void gather(Label label, std::vector<float>& out) const;
  void push(Label label);
  void apply_data(Label label);

  PassView pass_{};
  Eigen::AlignedBox3i region_, coarse_;  ///< nodes of the tile and kSweeps around it; nodes of `before` around these
  std::size_t stride_y_ = 0, stride_z_ = 0;
  std::vector<Label> labels_;
  std::vector<float> inverse_;     ///< [region] 1 / (6 + screening + stiffness w), 0 beyond the lattice
  std::vector<float> source_;      ///< [region] stiffness w d of the label
  std::vector<float> now_, next_;  ///< [region]
  std::vector<float> coarse_shares_, along_x_, along_y_;
};

}  // namespace sonoloft
