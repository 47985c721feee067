#pragma once
// Beside the stages:  slice -> [BACKGROUND] -> field (what lies behind unknown walls), cells (what needs a cut)
#include <Eigen/Geometry>
#include <bitset>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/slice/section.h"

namespace sonoloft {

/// Bricks of the lattice hold 8 x 8 x 8 nodes, and the cells between each of these and its upper neighbours.
inline constexpr int kBackgroundBrick = 8;
/// One bit a node or cell of a brick: bit x + 8 y + 64 z.
using BackgroundMask = std::bitset<kBackgroundBrick * kBackgroundBrick * kBackgroundBrick>;

inline constexpr double kBackgroundLargest = 1024;  ///< spacings along an edge of the box

/// Shares of labels at points. What no label listed has, none has: every column sums to 1.
struct PointShares {
  std::vector<Label> labels;  ///< [#L] ascending, outside always first
  std::vector<float> share;   ///< [#L][#P] 0..1 up to rounding
};

/// Cells of one brick of the lattice of which update() has news.
struct BackgroundChange {
  Eigen::Vector3i brick;
  BackgroundMask changed;       ///< cells in which shares() is no longer what it was: a corner changed
  BackgroundMask begun, ended;  ///< cells that became seeds (see Background::seeds), or are none any more
};

/// What is assumed where nothing was measured: for every label one function that fits all slices received and is smooth
/// between them (screened harmonic), near no slice the prior: outside. Solves
///   sum over 6 neighbours (g_j - g_i) + 16 w_i (d_i - g_i) + (1/8)^2 (prior - g_i) = 0
/// on a lattice of nodes `spacing` apart, w the known area per spacing^2 around a node, d the label's share of it;
/// beyond the box g is the prior. Shares are rounded at the nodes (to 1/256, below 1/4 to 1/64) and trilinear between
/// them; they always sum to 1. The shares depend on the slices held, as a set: on no order, no grouping into updates,
/// no number of threads, to the last bit. Frame: reference, mm. Threads: one writer (add, remove, update); const
/// members may run together, but not during these. Source: docs/pipeline/9-background.md.
class Background {
 public:
  /// @pre the box is not empty, spacing_mm > 0, no edge is longer than kBackgroundLargest spacings
  Background(const Eigen::AlignedBox3d& box, double spacing_mm);
  ~Background();
  Background(Background&&) noexcept;
  Background& operator=(Background&&) noexcept;

  /// Takes in the known part of a slice in the box, cut or not. local() knows it at once, shares() after the next
  /// update().
  /// @pre   at most 2^18 slices are held (counts would overflow)
  /// @cost  O(known area / spacing^2 + edges)
  void add(const Section& section);
  /// Takes back an add() of an equal section, to the bit. @pre it was added, and not taken back since
  void remove(const Section& section);

  /// Makes shares() fit what add() and remove() brought.
  /// @return by brick, ascending by z, y, x
  /// @cost   O(nodes near what changed, times the labels there)
  std::vector<BackgroundChange> update(int threads);

  /// Shares at many points; those of a call should lie near each other (a few bricks).
  /// @cost  O(#P #L + nodes in the points' bounding box)
  void shares(std::span<const Eigen::Vector3d> points_mm, PointShares& out) const;
  /// The labels that shares() can give a share in a box, ascending, outside always among them.
  [[nodiscard]] std::vector<Label> labels_near(const Eigen::AlignedBox3d& box) const;

  /// What the slices say right at a point, unsolved: the weight (1: as if one slice ran through it) and the labels'
  /// shares of it; the prior's where weight < 0.02.
  /// @param weight  out, [#P]
  void local(std::span<const Eigen::Vector3d> points_mm, std::vector<float>& weight, PointShares& out) const;

  /// Cells with corners of different largest labels (lowest of equals): through these the surfaces of shares() run. By
  /// brick, as update() returns them, `begun` only.
  [[nodiscard]] std::vector<BackgroundChange> seeds() const;

  /// Distance to the nearest known slice data, cut off at kBackgroundReach spacings.
  /// @param distance_mm  out, [#P] off by at most 1.2 spacings
  void distance(std::span<const Eigen::Vector3d> points_mm, std::vector<float>& distance_mm) const;

  [[nodiscard]] double spacing_mm() const;
  /// Of a cell of the lattice: that between node `bit` of a brick and its upper neighbours. Reference, mm.
  [[nodiscard]] Eigen::AlignedBox3d cell_box(const Eigen::Vector3i& brick, int bit) const;
  [[nodiscard]] std::size_t memory_bytes() const;  ///< of the nodes; O(bricks)

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Farther than this many spacings from all data, distance() is not told apart.
inline constexpr int kBackgroundReach = 8;

}  // namespace sonoloft
