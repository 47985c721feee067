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
  [[nodiscard]] const BrickTable<NodeShares>& shares() const { return passes_.back().shares; }

  /// @return what changed on the finest level, by ascending brick; valid until the next call
  const std::vector<RenewedNodes>& solve(int threads);

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Level {
    explicit Level(const Eigen::Vector3i& nodes) : data(nodes), touched(data.capacity()) {}
    BrickTable<NodeData> data;
    ChangedNodes touched;  ///< of which the data changed
  };
  /// Half of the sweeps of a level.
  struct Pass {
    explicit Pass(const Eigen::Vector3i& nodes) : shares(nodes) {}
    BrickTable<NodeShares> shares;
    std::vector<RenewedNodes> renewed;  ///< by ascending brick
  };
  static void tidy(Level& level);
  static void pull(const Level& fine, Level& coarse);
  [[nodiscard]] PassView view(std::size_t pass) const;
  [[nodiscard]] std::vector<Eigen::AlignedBox3i> stale_tiles(std::size_t pass) const;
  void run(std::size_t pass, int threads);
  void solve_tile(std::size_t pass, const Eigen::AlignedBox3i& bricks, TileSolver& solver,
                  std::vector<RenewedNodes>& renewed);
  [[nodiscard]] std::size_t level_of(std::size_t pass) const { return levels_.size() - 1 - pass / 2; }

  std::deque<Level> levels_;         ///< fine to coarse
  std::deque<Pass> passes_;          ///< in the order they run: two for every level, coarse to fine
  std::vector<TileSolver> solvers_;  ///< [#threads]
};

}  // namespace sonoloft
