#pragma once
// Which segments may meet: boxes of boxes over the segments in Morton order, for planar_network.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/slice/planar/planar_network.h"

namespace sonoloft {

struct GridSegment {
  GridPoint a, b;  ///< a < b
  friend bool operator==(const GridSegment&, const GridSegment&) = default;
};

/// Four boxes in every box, all levels full but for their end. Built in O(n log n), two dozen bytes a segment.
class SegmentTree {
 public:
  explicit SegmentTree(const std::vector<GridSegment>& segments);

  /// Calls visit(i, j) once for every two segments whose boxes overlap.
  /// @returns false when more than max_tests boxes had to be compared, or visit returned false: then it stopped there
  template <class Visit>
  bool visit_pairs(std::uint64_t max_tests, Visit&& visit) const {
    std::uint64_t tests_left = max_tests;
    return order_.empty() || pairs_within(top(), 0, 0, tests_left, visit);
  }

  /// Calls visit(i) for every segment whose box contains the point.
  /// @returns false when visit did
  template <class Visit>
  bool visit_containing(GridPoint point, Visit&& visit) const {
    return order_.empty() || containing(top(), 0, point, visit);
  }

 private:
  static constexpr std::uint32_t kFan = 4;
  struct Box {
    std::int32_t x0, y0, x1, y1;
    bool overlaps(const Box& o) const { return x0 <= o.x1 && o.x0 <= x1 && y0 <= o.y1 && o.y0 <= y1; }
  };
  using Level = std::vector<Box>;

  std::size_t top() const { return levels_.size() - 1; }

  template <class Visit>
  bool pairs_within(std::size_t level, std::uint32_t i, std::uint32_t j, std::uint64_t& tests_left,
                    Visit&& visit) const {
    if (level == 0) return i == j || visit(order_[i], order_[j]);
    const Level& below = levels_[level - 1];
    const auto count = static_cast<std::uint32_t>(below.size());
    if (tests_left < kFan * kFan) return false;
    tests_left -= kFan * kFan;
    for (std::uint32_t c = kFan * i; c < std::min(kFan * (i + 1), count); ++c)
      for (std::uint32_t d = i == j ? c : kFan * j; d < std::min(kFan * (j + 1), count); ++d)
        if (below[c].overlaps(below[d]) && !pairs_within(level - 1, c, d, tests_left, visit)) return false;
    return true;
  }

  template <class Visit>
  bool containing(std::size_t level, std::uint32_t i, GridPoint p, Visit&& visit) const {
    if (!levels_[level][i].overlaps({p.x, p.y, p.x, p.y})) return true;
    if (level == 0) return visit(order_[i]);
    const auto count = static_cast<std::uint32_t>(levels_[level - 1].size());
    for (std::uint32_t c = kFan * i; c < std::min(kFan * (i + 1), count); ++c)
      if (!containing(level - 1, c, p, visit)) return false;
    return true;
  }

  std::vector<std::uint32_t> order_;  ///< [#S] segments in Morton order of their middles
  std::vector<Level> levels_;         ///< [0][k]: the box of segment order_[k]; [l + 1][k]: around [l][kFan * k ...]
};

}  // namespace sonoloft
