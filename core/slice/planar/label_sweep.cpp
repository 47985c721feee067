#include "core/slice/planar/label_sweep.h"

#include <algorithm>
#include <cassert>
#include <memory_resource>
#include <numeric>
#include <set>
#include <span>
#include <tuple>

#include "core/slice/planar/enclosing_sets.h"

namespace sonoloft {
namespace {

using Set = EnclosingSets::Set;

struct SweptEdge {
  std::size_t first_record, last_record;  ///< its owners
  std::uint32_t a, b;
  Set above, below;
};

/// Carries the set of enclosing contours upwards through the segments over a point that moves by x, then y.
class Sweep {
 public:
  Sweep(const std::vector<OwnedSegment>& records, std::uint32_t owner_count)
      : records_(records), sets_(owner_count), twice_area_(owner_count, 0), active_(Above{this}, &pool_) {
    collect_edges();
    collect_points();
  }

  void run() {
    std::uint32_t next_edge = 0;
    for (std::uint32_t p = 0; p < points_.size(); ++p) {
      const auto [first, last] = active_.equal_range(points_[p]);
      Set set = first == active_.begin() ? EnclosingSets::kEmpty : edges_[*std::prev(first)].above;
      for (auto it = first; it != last; ++it) {
        assert(end(*it) == points_[p]);  // else the segments were not split
        edges_[*it].b = p;
      }
      const auto next = active_.erase(first, last);

      const std::uint32_t begin = next_edge;
      while (next_edge < edges_.size() && start(next_edge) == points_[p]) ++next_edge;
      std::sort(edges_.begin() + begin, edges_.begin() + next_edge, [&](const SweptEdge& e, const SweptEdge& f) {
        return orient(points_[p], records_[e.first_record].b, records_[f.first_record].b) > 0;
      });
      for (std::uint32_t e = begin; e < next_edge; ++e) {
        set = pass(edges_[e], p, set);
        active_.emplace_hint(next, e);
      }
    }
    assert(active_.empty());
  }

  const std::vector<SweptEdge>& edges() const { return edges_; }
  const EnclosingSets& sets() const { return sets_; }
  /// Twice the area that each owner encloses; complete after run(). Modulo 2^64 on the way, exact in the end.
  std::span<const std::uint64_t> twice_area() const { return twice_area_; }
  std::vector<GridPoint> take_points() { return std::move(points_); }

 private:
  /// Order of segments that lie over one point. A point is equal to the segments that it lies on.
  struct Above {
    using is_transparent = void;
    const Sweep* sweep;
    bool operator()(std::uint32_t e, GridPoint p) const { return orient(sweep->start(e), sweep->end(e), p) > 0; }
    bool operator()(GridPoint p, std::uint32_t e) const { return orient(sweep->start(e), sweep->end(e), p) < 0; }
    bool operator()(std::uint32_t e, std::uint32_t f) const {
      if (sweep->start(f) < sweep->start(e)) return below_later(f, e) < 0;
      return below_later(e, f) > 0;
    }
    /// Positive where f, which starts no earlier than e, is above e.
    std::int64_t below_later(std::uint32_t e, std::uint32_t f) const {
      const std::int64_t side = orient(sweep->start(e), sweep->end(e), sweep->start(f));
      return side != 0 ? side : orient(sweep->start(e), sweep->end(e), sweep->end(f));
    }
  };

  GridPoint start(std::uint32_t edge) const { return records_[edges_[edge].first_record].a; }
  GridPoint end(std::uint32_t edge) const { return records_[edges_[edge].first_record].b; }

  void collect_edges() {
    edges_.reserve(records_.size());
    for (std::size_t i = 0; i < records_.size(); ++i) {
      if (i == 0 || records_[i].a != records_[i - 1].a || records_[i].b != records_[i - 1].b)
        edges_.push_back({i, i + 1, 0, 0, 0, 0});
      else
        edges_.back().last_record = i + 1;
    }
  }

  void collect_points() {
    points_.reserve(2 * edges_.size());
    for (std::uint32_t e = 0; e < edges_.size(); ++e) points_.insert(points_.end(), {start(e), end(e)});
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
  }

  /// Labels an edge that starts in point p over a region that `below` encloses; adds the edge to its owners' areas.
  Set pass(SweptEdge& edge, std::uint32_t p, Set below) {
    edge.a = p;
    edge.below = edge.above = below;
    const OwnedSegment& s = records_[edge.first_record];
    const auto under = static_cast<std::uint64_t>((std::int64_t{s.a.y} + s.b.y) * (std::int64_t{s.b.x} - s.a.x));
    for (std::size_t r = edge.first_record; r < edge.last_record; ++r) {
      const std::uint32_t owner = records_[r].owner;
      twice_area_[owner] += sets_.contains(below, owner) ? under : 0 - under;
      edge.above = sets_.toggled(edge.above, owner);
    }
    return edge.above;
  }

  const std::vector<OwnedSegment>& records_;
  EnclosingSets sets_;
  std::vector<std::uint64_t> twice_area_;
  std::vector<SweptEdge> edges_;
  std::vector<GridPoint> points_;
  std::pmr::unsynchronized_pool_resource pool_;
  std::pmr::set<std::uint32_t, Above> active_;
};

/// The place of every owner in the order of the rule; the field of view comes last.
std::vector<std::uint32_t> ranks(std::span<const std::uint64_t> twice_area, const std::vector<Enclosure>& enclosures) {
  std::vector<std::uint32_t> order(enclosures.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t c, std::uint32_t d) {
    return std::tuple(twice_area[c], enclosures[c].hole, c) < std::tuple(twice_area[d], enclosures[d].hole, d);
  });
  std::vector<std::uint32_t> rank(enclosures.size() + 1);
  for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
  rank.back() = static_cast<std::uint32_t>(order.size());
  return rank;
}

}  // namespace

LabelledNetwork label_sweep(const std::vector<OwnedSegment>& segments, const std::vector<Enclosure>& enclosures,
                            bool has_view) {
  const auto view = static_cast<std::uint32_t>(enclosures.size());
  Sweep sweep(segments, view + 1);
  sweep.run();
  const std::vector<std::uint32_t> decisive = sweep.sets().lowest(ranks(sweep.twice_area(), enclosures));
  const auto label = [&](Set set) {
    if (has_view && !sweep.sets().contains(set, view)) return kUnknown;
    const std::uint32_t contour = decisive[set];
    return contour == EnclosingSets::kNone || contour == view ? kOutside : enclosures[contour].label;
  };
  LabelledNetwork out;
  out.edges.reserve(sweep.edges().size());
  for (const SweptEdge& e : sweep.edges()) out.edges.push_back({e.a, e.b, label(e.above), label(e.below)});
  out.points = sweep.take_points();
  return out;
}

}  // namespace sonoloft
