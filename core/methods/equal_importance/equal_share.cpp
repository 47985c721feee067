#include "core/methods/equal_importance/equal_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace sonoloft {
namespace {

/// Sweeps stop when no share changes by more, or after so many.
constexpr float kSettled = 1e-5F;
constexpr int kMostSweeps = 400;
/// A contour nearer than so many steps of the grid is a neighbour itself.
constexpr float kBeside = 2.3F;

/// What a node is compared with.
struct Neighbour {
  std::ptrdiff_t step;
  float distance;  ///< steps of the grid
};

/// The 16 directions of steps of up to two nodes.
std::array<Neighbour, 16> neighbours(const PlaneGrid& grid) {
  std::array<Neighbour, 16> out{};
  std::size_t n = 0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x)
      if ((x != 0 || y != 0) && !(x % 2 == 0 && y % 2 == 0))
        out[n++] = {x + std::ptrdiff_t{y} * grid.width, std::hypot(static_cast<float>(x), static_cast<float>(y))};
  return out;
}

class Solver {
 public:
  Solver(const PlaneGrid& grid, const std::vector<float>& lower_mm, const std::vector<float>& upper_mm)
      : grid_(grid),
        lower_mm_(lower_mm),
        upper_mm_(upper_mm),
        beside_(neighbours(grid)),
        shares_(grid.size(), Share{}) {
    for (std::size_t n = 0; n < grid.size(); ++n) {
      if (!between(n)) continue;
      nodes_.push_back(static_cast<std::uint32_t>(n));
      const float a = std::abs(lower_mm[n]), b = std::abs(upper_mm[n]);
      shares_[n].way = a / std::max(a + b, 1e-30F);
    }
  }

  std::vector<Share> run() {
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      float change = 0;
      if (sweep % 2 == 0)
        for (auto n = nodes_.begin(); n != nodes_.end(); ++n) change = std::max(change, renew(*n));
      else
        for (auto n = nodes_.rbegin(); n != nodes_.rend(); ++n) change = std::max(change, renew(*n));
      if (change < kSettled) break;
    }
    return std::move(shares_);
  }

 private:
  struct Seen {
    float way, distance;
  };

  [[nodiscard]] bool between(std::size_t n) const { return (lower_mm_[n] > 0) != (upper_mm_[n] > 0); }

  /// The value between the two neighbours that pull hardest apart, where it pulls equally at both. @return the change
  float renew(std::uint32_t node) {
    const auto spacing = static_cast<float>(grid_.spacing_mm);
    std::array<Seen, 18> seen;
    std::size_t count = 0;
    for (const Neighbour& n : beside_) {
      const auto at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(node) + n.step);
      if (at < shares_.size() && between(at) && (lower_mm_[at] > 0) == (lower_mm_[node] > 0))
        seen[count++] = {shares_[at].way, n.distance};
    }
    const float a = std::abs(lower_mm_[node]) / spacing, b = std::abs(upper_mm_[node]) / spacing;
    if (a < kBeside) seen[count++] = {0, std::max(a, 1e-3F)};
    if (b < kBeside) seen[count++] = {1, std::max(b, 1e-3F)};
    Share best{shares_[node].way, 0};
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const float apart = seen[i].distance + seen[j].distance, pull = std::abs(seen[i].way - seen[j].way) / apart;
        if (pull > best.per_mm)
          best = {(seen[i].way * seen[j].distance + seen[j].way * seen[i].distance) / apart, pull};
      }
    best.per_mm /= spacing;
    const float change = std::abs(best.way - shares_[node].way);
    shares_[node] = best;
    return change;
  }

  const PlaneGrid& grid_;
  const std::vector<float>&lower_mm_, &upper_mm_;
  std::array<Neighbour, 16> beside_;
  std::vector<std::uint32_t> nodes_;
  std::vector<Share> shares_;
};

}  // namespace

std::vector<Share> equal_shares(const PlaneGrid& grid, const std::vector<float>& lower_mm,
                                const std::vector<float>& upper_mm) {
  return Solver(grid, lower_mm, upper_mm).run();
}

}  // namespace sonoloft
