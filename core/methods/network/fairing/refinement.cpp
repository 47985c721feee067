#include "core/methods/network/fairing/refinement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

namespace sonoloft::network {
namespace {

constexpr int kRounds = 10, kRelaxations = 6;
/// Of an edge: what rounding leaves between a vertex and a wall that it was put on.
constexpr double kOnWall = 1e-9;

using Corners = std::array<std::uint32_t, 3>;
using Eigen::Vector3d;

/// A triangle at an edge, which runs from corner `at` to the next.
struct EdgeUse {
  std::uint32_t low, high, triangle, at;
  friend auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

class Refiner {
 public:
  Refiner(JoinedCells& cells, double growth) : cells_(cells), s_(cells.surfaces), growth_(growth) {}

  void run() {
    find_lengths();
    for (int round = 1; round <= kRounds; ++round) {
      split(std::numbers::sqrt2 * round / kRounds);
      for (int i = 0; i < kRelaxations && relax(); ++i) {
      }
    }
  }

 private:
  /// Ascending: those of the same edge together.
  std::vector<EdgeUse> edge_uses() const {
    std::vector<std::size_t> first(s_.positions.size() + 1, 0);  // [low]
    each_use([&](const EdgeUse& use) { ++first[use.low + 1]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<EdgeUse> uses(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    each_use([&](const EdgeUse& use) { uses[next[use.low]++] = use; });
    for (std::size_t v = 0; v + 1 < first.size(); ++v)
      std::sort(uses.begin() + static_cast<std::ptrdiff_t>(first[v]),
                uses.begin() + static_cast<std::ptrdiff_t>(first[v + 1]));
    return uses;
  }
  template <class Visit>
  void each_use(const Visit& visit) const {
    for (std::uint32_t t = 0; t < s_.triangles.size(); ++t)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(s_.triangles[t][i], s_.triangles[t][(i + 1) % 3]);
        visit(EdgeUse{low, high, t, i});
      }
  }

  /// [#V] how long edges are to be: as those of the contour there, or as near the contours that it is joined to.
  void find_lengths() {
    lengths_.assign(s_.positions.size(), 0);
    std::vector<int> count(s_.positions.size(), 0);
    const std::vector<EdgeUse> uses = edge_uses();
    for (const EdgeUse& use : uses) {
      if (!cells_.on_slices(use.high)) continue;
      const double length = (s_.positions[use.low] - s_.positions[use.high]).norm();
      for (const std::uint32_t v : {use.low, use.high}) lengths_[v] += length, ++count[v];
    }
    for (std::size_t v = 0; v < lengths_.size(); ++v)
      if (count[v] > 0) lengths_[v] /= count[v];
    const double mean = mean_length();
    for (bool any = true; any;) {
      any = false;
      std::vector<double> sum(lengths_.size(), 0);
      std::vector<int> from(lengths_.size(), 0);
      for (const EdgeUse& use : uses)
        for (const auto& [a, b] : {std::pair{use.low, use.high}, std::pair{use.high, use.low}})
          if (lengths_[a] == 0 && lengths_[b] > 0)
            sum[a] += lengths_[b] + growth_ * (s_.positions[a] - s_.positions[b]).norm(), ++from[a];
      for (std::size_t v = 0; v < lengths_.size(); ++v)
        if (from[v] > 0) lengths_[v] = sum[v] / from[v], any = true;
    }
    std::ranges::replace(lengths_, 0.0, mean);  // of parts that no contour is in
  }

  [[nodiscard]] double mean_length() const {
    double sum = 0;
    for (const double length : lengths_) sum += length;
    return sum / static_cast<double>(std::ranges::count_if(lengths_, [](double length) { return length > 0; }));
  }

  void split(double factor) {
    const std::size_t count = s_.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      const Corners c = s_.triangles[t];
      const Vector3d middle = (s_.positions[c[0]] + s_.positions[c[1]] + s_.positions[c[2]]) / 3;
      const double length = (lengths_[c[0]] + lengths_[c[1]] + lengths_[c[2]]) / 3;
      const bool is_large = std::ranges::all_of(c, [&](std::uint32_t v) {
        return factor * (s_.positions[v] - middle).norm() > std::max(length, lengths_[v]);
      });
      if (!is_large) continue;
      const auto v = static_cast<std::uint32_t>(s_.positions.size());
      s_.positions.push_back(middle);
      lengths_.push_back(length);
      s_.triangles[t] = {c[0], c[1], v};
      for (const Corners& part : {Corners{c[1], c[2], v}, Corners{c[2], c[0], v}}) {
        s_.triangles.push_back(part);
        s_.label_front.push_back(s_.label_front[t]);
        s_.label_back.push_back(s_.label_back[t]);
        cells_.cell_of.push_back(cells_.cell_of[t]);
      }
    }
  }

  /// Turns edges, none of a triangle twice. @return whether any
  bool relax() {
    const std::vector<EdgeUse> uses = edge_uses();
    std::vector<bool> turned(s_.triangles.size(), false);
    std::set<std::pair<std::uint32_t, std::uint32_t>> fresh;
    bool any = false;
    for (auto first = uses.begin(); first != uses.end();) {
      auto last = first;
      while (last != uses.end() && last->low == first->low && last->high == first->high) ++last;
      if (last - first == 2 && !turned[first->triangle] && !turned[first[1].triangle] && may_turn(first[0], first[1])) {
        const std::pair<std::uint32_t, std::uint32_t> ends = std::minmax({opposite(first[0]), opposite(first[1])});
        const bool exists = std::ranges::binary_search(uses, ends, {}, [](const EdgeUse& u) {
          return std::pair{u.low, u.high};
        });
        if (!exists && fresh.insert(ends).second) {
          turn(first[0], first[1]);
          turned[first->triangle] = turned[first[1].triangle] = any = true;
        }
      }
      first = last;
    }
    return any;
  }
  std::uint32_t opposite(const EdgeUse& use) const { return s_.triangles[use.triangle][(use.at + 2) % 3]; }

  bool may_turn(const EdgeUse& a, const EdgeUse& b) const {
    const std::uint32_t c = opposite(a), d = opposite(b);
    if (cells_.on_slices(a.high) || (cells_.on_slices(c) && cells_.on_slices(d)) || c == d) return false;
    const bool same_way = s_.triangles[a.triangle][a.at] == s_.triangles[b.triangle][b.at];
    if (same_way || s_.label_front[a.triangle] != s_.label_front[b.triangle] ||
        s_.label_back[a.triangle] != s_.label_back[b.triangle] || !cell_of_both(a, b))
      return false;
    const Vector3d p = s_.positions[s_.triangles[a.triangle][a.at]], q = s_.positions[s_.triangles[b.triangle][b.at]],
                   r = s_.positions[c], t = s_.positions[d];
    if (angle(r, p, q) + angle(t, p, q) <= std::numbers::pi + 1e-6) return false;
    const Vector3d m = (q - p).cross(r - p), n = (t - p).cross(q - p), both = m + n;
    if (m.dot(n) < 0.5 * m.norm() * n.norm()) return false;  // a crease
    return (t - r).cross(q - r).dot(both) > 0 && (t - r).cross(p - r).dot(both) < 0;
  }
  /// A cell that both triangles lie in: convex, it holds what they are turned into.
  std::optional<std::uint32_t> cell_of_both(const EdgeUse& a, const EdgeUse& b) const {
    const std::uint32_t of_a = cells_.cell_of[a.triangle], of_b = cells_.cell_of[b.triangle];
    const auto holds = [&](std::uint32_t cell, std::uint32_t vertex) {
      const Vector3d& p = s_.positions[vertex];
      const double least_mm = -kOnWall * (s_.positions[a.low] - p).norm();
      return std::ranges::all_of(cells_.walls[cell], [&](const auto& w) { return w.signedDistance(p) >= least_mm; });
    };
    if (of_a == of_b || holds(of_a, opposite(b))) return of_a;
    if (holds(of_b, opposite(a))) return of_b;
    return std::nullopt;
  }
  static double angle(const Vector3d& at, const Vector3d& a, const Vector3d& b) {
    return std::atan2((a - at).cross(b - at).norm(), (a - at).dot(b - at));
  }

  void turn(const EdgeUse& a, const EdgeUse& b) {
    const std::uint32_t c = opposite(a), d = opposite(b), p = s_.triangles[a.triangle][a.at],
                        q = s_.triangles[b.triangle][b.at];
    cells_.cell_of[a.triangle] = cells_.cell_of[b.triangle] = *cell_of_both(a, b);
    s_.triangles[a.triangle] = {c, p, d};
    s_.triangles[b.triangle] = {d, q, c};
  }

  JoinedCells& cells_;
  ContourSurfaces& s_;
  double growth_;
  std::vector<double> lengths_;
};

}  // namespace

void refine(JoinedCells& cells, double growth) {
  Refiner(cells, growth).run();
}

}  // namespace sonoloft::network
