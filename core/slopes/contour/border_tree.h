#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/slopes/contour/arcs.h"

namespace sonoloft {

/// The borders of a slice, to find which is nearest and which meet a line: boxes of eight over edges in the order of
/// their arcs, where neighbours lie near each other anyway. Frame: image, mm. Threads: any.
class BorderTree {
 public:
  BorderTree(const Section& section, const Arcs& arcs);

  struct Nearest {
    float distance_mm;
    Label label;          ///< of the point asked for
    Label left, right;    ///< of the edge
    std::uint32_t block;  ///< a hint for a point nearby
  };
  /// What lies nearer than reach_mm; of edges that meet in the nearest point, the one that the point faces more.
  /// @param label  of a side of the edge, when given
  /// @param hint   a block to look at first
  /// @cost  O(log #edges) where the nearest is much nearer than others
  [[nodiscard]] std::optional<Nearest> nearest(const Eigen::Vector2d& point_mm, double reach_mm,
                                               std::optional<Label> label, std::uint32_t hint) const;

  /// Calls visit(place) for edges (those that start at a place), all that meet a line among them.
  /// @param normal  length 1; the line is normal . x + offset_mm = 0
  template <class Visit>
  void visit_near_line(const Eigen::Vector2d& normal, double offset_mm, Visit&& visit) const {
    if (!empty()) visit_line(levels_.size() - 1, 0, normal, offset_mm + normal.dot(origin_), visit);
  }

  [[nodiscard]] bool empty() const { return blocks_.empty(); }

 private:
  static constexpr std::uint32_t kFan = 8;
  using Lanes = std::array<float, kFan>;
  /// Of children; those that are none lie at infinity.
  struct Boxes {
    Lanes x0, y0, x1, y1;
    std::array<std::uint32_t, kFan> labels;  ///< a bit for each label on either side; labels may share one
  };
  /// Edges of one arc, the last one repeated.
  struct Block {
    Lanes ax, ay, bx, by, inverse_length2;
    std::uint32_t first, count;  ///< places
    Label left, right;
  };
  struct Search;

  void add_block(const Section& section, const Arcs& arcs, const Arc& arc, std::uint32_t first);
  void add_levels();
  [[nodiscard]] static std::uint32_t label_bit(Label label) { return 1u << (label % 32u); }
  void look_at(const Block& block, Search& search) const;
  void descend(std::size_t level, std::uint32_t node, Search& search) const;

  template <class Visit>
  void visit_line(std::size_t level, std::uint32_t node, const Eigen::Vector2d& n, double offset, Visit& visit) const {
    constexpr double kSlack = 1e-5;  // of coordinates, for single precision
    const Boxes& boxes = levels_[level][node];
    for (std::uint32_t i = 0; i < kFan && std::isfinite(boxes.x0[i]); ++i) {
      const Eigen::Vector2d low(boxes.x0[i], boxes.y0[i]), high(boxes.x1[i], boxes.y1[i]);
      const double reach = n.cwiseAbs().dot(0.5 * (high - low)) + kSlack * extent_mm_;
      if (std::abs(n.dot(0.5 * (low + high)) + offset) > reach) continue;
      const std::uint32_t child = kFan * node + i;
      if (level > 0) {
        visit_line(level - 1, child, n, offset, visit);
        continue;
      }
      for (std::uint32_t k = 0; k < blocks_[child].count; ++k) visit(blocks_[child].first + k);
    }
  }

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();  ///< what follows is relative to it
  double extent_mm_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::vector<Boxes>> levels_;  ///< [0][k]: of blocks 8k ... 8k+7; [l+1][k]: of [l][8k ... 8k+7]
};

}  // namespace sonoloft
