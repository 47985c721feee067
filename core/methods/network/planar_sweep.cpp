#include "core/methods/network/planar_sweep.h"

#include <algorithm>
#include <cassert>

namespace sonoloft::network {
namespace {

using Chain = std::vector<std::uint32_t>;

/// An edge that the sweep line crosses, and what lies above it still without triangles: left of it a chain of vertices
/// from this edge's left end up to that of the edge above, all turning towards the sweep line.
struct ActiveEdge {
  std::uint32_t left, right;
  Chain chain;  ///< of the uppermost edge: empty, nothing lies above it
};

class Sweep {
 public:
  Sweep(std::span<const SheetPoint> points, std::span<const std::array<std::uint32_t, 2>> edges)
      : points_(points), rank_(points.size()), starting_(points.size()) {
    for (const auto& ends : edges) order_.insert(order_.end(), ends.begin(), ends.end());
    std::ranges::sort(order_);
    order_.erase(std::unique(order_.begin(), order_.end()), order_.end());
    std::ranges::sort(order_, [&](std::uint32_t a, std::uint32_t b) {
      return CGAL::compare_xy(points_[a].at, points_[b].at) == CGAL::SMALLER;
    });
    for (std::uint32_t i = 0; i < order_.size(); ++i) rank_[order_[i]] = i;
    for (const auto& [a, b] : edges) starting_[rank_[a] < rank_[b] ? a : b].push_back(rank_[a] < rank_[b] ? b : a);
    for (std::uint32_t v = 0; v < points.size(); ++v)
      std::ranges::sort(starting_[v], [&](std::uint32_t a, std::uint32_t b) { return turn_of(v, a, b) > 0; });
  }

  std::vector<std::array<std::uint32_t, 3>> triangles() {
    for (const std::uint32_t v : order_) visit(v);
    return std::move(triangles_);
  }

 private:
  int turn_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return turn_at(points_[a], points_[b], points_[c]);
  }
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles_.push_back({a, b, c}); }

  void visit(std::uint32_t v) {
    const auto is_below = [&](const ActiveEdge& e) { return e.right != v && turn_of(e.left, e.right, v) > 0; };
    const auto first = std::ranges::partition_point(active_, is_below);
    const auto last = std::find_if(first, active_.end(), [&](const ActiveEdge& e) { return e.right != v; });
    Chain below, above;  // what is open beside v
    if (first != last) {
      for (auto e = first; e + 1 != last; ++e)
        for (std::size_t i = 0; i + 1 < e->chain.size(); ++i) add(e->chain[i], v, e->chain[i + 1]);
      above = std::move(std::prev(last)->chain);
      if (first != active_.begin()) below = std::move(std::prev(first)->chain);
    } else if (first != active_.begin()) {  // v opens a gap: it sees what was visited last in it
      const Chain& chain = std::prev(first)->chain;
      const auto seen = std::ranges::max_element(chain, {}, [&](std::uint32_t c) { return rank_[c]; });
      assert(seen != chain.end());
      below.assign(chain.begin(), seen + 1);
      above.assign(seen, chain.end());
    }
    extend_upwards(below, v);
    extend_downwards(above, v);
    replace(first, last, v, std::move(below), std::move(above));
  }

  void extend_upwards(Chain& chain, std::uint32_t v) {
    if (chain.empty()) return;
    for (; chain.size() > 1 && turn_of(*(chain.end() - 2), v, chain.back()) > 0; chain.pop_back())
      add(*(chain.end() - 2), v, chain.back());
    chain.push_back(v);
  }
  void extend_downwards(Chain& chain, std::uint32_t v) {
    if (chain.empty()) return;
    auto c = chain.begin();
    for (; c + 1 != chain.end() && turn_of(*c, v, *(c + 1)) > 0; ++c) add(*c, v, *(c + 1));
    chain.erase(chain.begin(), c);
    chain.insert(chain.begin(), v);
  }

  /// The edges that end at v make way for those that start there.
  void replace(std::vector<ActiveEdge>::iterator first, std::vector<ActiveEdge>::iterator last, std::uint32_t v,
               Chain below, Chain above) {
    const Chain& starting = starting_[v];
    if (starting.empty() && !above.empty()) below.insert(below.end(), above.begin() + 1, above.end());
    if (first != active_.begin()) std::prev(first)->chain = std::move(below);
    auto place = active_.erase(first, last);
    for (std::size_t i = 0; i < starting.size(); ++i)
      place = active_.insert(place, {v, starting[i], i + 1 < starting.size() ? Chain{v} : std::move(above)}) + 1;
  }

  std::span<const SheetPoint> points_;
  Chain order_, rank_;
  std::vector<Chain> starting_;     ///< [#V] right ends of the edges that start there, upwards
  std::vector<ActiveEdge> active_;  ///< upwards
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

int turn_at(const SheetPoint& a, const SheetPoint& b, const SheetPoint& c) {
  for (const std::uint32_t line : a.lines)
    if (std::ranges::count(b.lines, line) != 0 && std::ranges::count(c.lines, line) != 0) return 0;
  return turn(a.at, b.at, c.at);
}

std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const SheetPoint> points,
                                                      std::span<const std::array<std::uint32_t, 2>> edges) {
  return Sweep(points, edges).triangles();
}

}  // namespace sonoloft::network
