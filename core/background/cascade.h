#pragma once
// update:  NodeData -> [CASCADE] -> NodeShares
#include <bitset>
#include <deque>
#include <vector>

#include "core/background/brick_table.h"
#include "core/background/tile_solver.h"

namespace sonoloft {

/// Nodes of one brick of which the shares changed: bit node_index().
struct RenewedNodes {
  std::size_t brick;
  std::bitset<kBrickNodes> nodes;
};

/// Solves the equation of the background from coarse to fine with a fixed number of sweeps on every level, and again
/// only where it must: the shares after solve() are a function of the data alone, to the last bit.
class Cascade {
 public:
  explicit Cascade(const Eigen::Vector3i& nodes);

  [[nodiscard]] BrickTable<NodeData>& data() { return levels_.front().data; }
  [[nodiscard]] const BrickTable<NodeData>& data() const { return levels_.front().data; }
  /// Where the caller notes which nodes' data it changed.
  [[nodiscard]] ChangedNodes& touched() { return levels_.front().touched; }
  [[nodiscard]] const BrickTable<NodeShares>& shares() const { return levels_.front().shares; }

  /// @return what changed on the finest level, by ascending brick; valid until the next call
  const std::vector<RenewedNodes>& solve(int threads);

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Level {
    explicit Level(const Eigen::Vector3i& nodes) : data(nodes), shares(nodes), touched(data.capacity()) {}
    BrickTable<NodeData> data;
    BrickTable<NodeShares> shares;
    ChangedNodes touched;               ///< of which the data changed
    std::vector<RenewedNodes> renewed;  ///< by ascending brick
  };
  void tidy(Level& level);
  void pull(const Level& fine, Level& coarse);
  [[nodiscard]] std::vector<Eigen::AlignedBox3i> stale_tiles(std::size_t level) const;
  void solve_level(std::size_t level, int threads);
  void solve_tile(std::size_t level, const Eigen::AlignedBox3i& bricks, TileSolver& solver,
                  std::vector<RenewedNodes>& renewed);

  std::deque<Level> levels_;         ///< fine to coarse
  std::vector<TileSolver> solvers_;  ///< [#threads]
};

}  // namespace sonoloft
