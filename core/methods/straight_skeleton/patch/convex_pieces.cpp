#include "core/methods/straight_skeleton/patch/convex_pieces.h"

#include <algorithm>
#include <cassert>

namespace sonoloft::skeleton {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// A side seen from the piece on its left.
struct Half {
  std::uint32_t from, next;
  std::optional<std::uint32_t> line;
  int sign = 1;
};

class Divider {
 public:
  Divider(const PatchMap& map, double reach_mm) {
    spots_ = map.spots;
    if (!map.bounded) {
      const auto first = static_cast<std::uint32_t>(spots_.size());
      for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        spots_.emplace_back(reach_mm * corner);
      add_loop(std::vector{first, first + 1, first + 2, first + 3}, false);
    }
    for (const auto& loop : map.rims) add_loop(loop, true);
  }

  ConvexPieces run() {
    for (bool any = true; any;) {
      any = false;
      for (std::uint32_t h = 0; h < halves_.size(); ++h)
        if (is_reflex(h)) cut_at(h), any = true;
    }
    std::vector<bool> seen(halves_.size(), false);
    for (std::uint32_t h = 0; h < halves_.size(); ++h)
      if (!seen[h]) out_.pieces.push_back(piece_of(h, seen));
    return std::move(out_);
  }

 private:
  void add_loop(const std::vector<std::uint32_t>& loop, bool rim) {
    const auto first = static_cast<std::uint32_t>(halves_.size());
    for (std::uint32_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t to = i + 1 < loop.size() ? i + 1 : 0;
      Half half{loop[i], first + to, std::nullopt};
      if (rim) {
        half.line = static_cast<std::uint32_t>(out_.lines.size());
        out_.lines.push_back({spots_[loop[i]], spots_[loop[to]]});
      }
      halves_.push_back(half);
    }
  }

  std::uint32_t to(std::uint32_t h) const { return halves_[halves_[h].next].from; }
  const Spot& start(std::uint32_t h) const { return spots_[halves_[h].from]; }
  const Spot& end(std::uint32_t h) const { return spots_[to(h)]; }
  bool is_reflex(std::uint32_t h) const { return turn(start(h), end(h), end(halves_[h].next)) < 0; }

  struct Hit {
    Exact way;  ///< along the continuation, positive
    std::uint32_t half = kNone;
    bool at_start = false;
    Spot spot;
  };
  /// Where the continuation of a side beyond its end meets the next one.
  Hit hit_of(std::uint32_t h) const {
    const Spot &u = start(h), &v = end(h);
    Hit best;
    for (std::uint32_t k = 0; k < halves_.size(); ++k) {
      const Spot &a = start(k), &b = end(k);
      const int at_a = turn(u, v, a), at_b = turn(u, v, b);
      if (at_a == 0 && sees_corner(k, v)) consider(best, {way_of(u, v, a), k, true, a});
      if (at_a * at_b >= 0 || turn(a, b, v) <= 0) continue;
      const Exact t = cross(u, a, a, b) / cross(u, v, a, b);
      const Spot spot = between(u, v, t);
      consider(best, {t - Exact(1), k, false, spot});
    }
    return best;
  }
  static Exact way_of(const Spot& u, const Spot& v, const Spot& p) {
    const Eigen::Vector2d way = (v.rough - u.rough).cwiseAbs();
    return way.x() > way.y() ? (p.x - v.x) / (v.x - u.x) : (p.y - v.y) / (v.y - u.y);
  }
  static void consider(Hit& best, Hit hit) {
    if (sign_of(hit.way) > 0 && (best.half == kNone || sign_of(hit.way - best.way) < 0)) best = std::move(hit);
  }
  /// Whether a point is seen from the corner where a side starts, through the piece on its left.
  bool sees_corner(std::uint32_t k, const Spot& p) const {
    if (&start(k) == &p) return false;
    const std::uint32_t before = before_of(k);
    const int in = turn(start(before), start(k), p), out = turn(start(k), end(k), p);
    return turn(start(before), start(k), end(k)) >= 0 ? in > 0 && out > 0 : in > 0 || out > 0;
  }
  std::uint32_t before_of(std::uint32_t k) const {
    std::uint32_t before = 0;
    while (halves_[before].next != k) ++before;
    return before;
  }

  void cut_at(std::uint32_t h) {
    const Hit hit = hit_of(h);
    assert(hit.half != kNone);
    std::uint32_t arriving = 0, leaving = hit.half;  // at the far end
    if (hit.at_start) {
      arriving = before_of(hit.half);
    } else {
      const auto w = static_cast<std::uint32_t>(spots_.size());
      spots_.push_back(hit.spot);
      arriving = hit.half;
      leaving = static_cast<std::uint32_t>(halves_.size());
      halves_.push_back({w, halves_[arriving].next, halves_[arriving].line, halves_[arriving].sign});
      halves_[arriving].next = leaving;
    }
    const std::uint32_t v = to(h), w = halves_[leaving].from, after = halves_[h].next;
    const auto there = static_cast<std::uint32_t>(halves_.size()), back = there + 1;
    halves_.push_back({v, leaving, halves_[h].line, halves_[h].sign});
    halves_.push_back({w, after, halves_[h].line, -halves_[h].sign});
    halves_[h].next = there;
    halves_[arriving].next = back;
  }

  std::vector<PieceSide> piece_of(std::uint32_t first, std::vector<bool>& seen) const {
    std::vector<std::uint32_t> loop;
    for (std::uint32_t h = first; !seen[h]; h = halves_[h].next) {
      seen[h] = true;
      loop.push_back(h);
    }
    const auto goes_on = [&](std::uint32_t h, std::uint32_t next) {
      return halves_[h].line && halves_[h].line == halves_[next].line && halves_[h].sign == halves_[next].sign;
    };
    const auto corner = std::ranges::find_if(
        loop, [&](const std::uint32_t& h) { return !goes_on(&h == &loop.front() ? loop.back() : *(&h - 1), h); });
    std::rotate(loop.begin(), corner, loop.end());
    std::vector<PieceSide> sides;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (i > 0 && goes_on(loop[i - 1], loop[i]))
        sides.back().b = end(loop[i]);
      else
        sides.push_back({start(loop[i]), end(loop[i]), halves_[loop[i]].line, halves_[loop[i]].sign});
    }
    return sides;
  }

  std::vector<Spot> spots_;
  std::vector<Half> halves_;
  ConvexPieces out_;
};

}  // namespace

ConvexPieces convex_pieces(const PatchMap& map, double reach_mm) {
  return Divider(map, reach_mm).run();
}

}  // namespace sonoloft::skeleton
