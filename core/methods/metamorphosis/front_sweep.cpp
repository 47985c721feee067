#include "core/methods/metamorphosis/front_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/methods/metamorphosis/front_arrival.h"

namespace sonoloft {
namespace {

/// Nodes so far from a contour, in steps of the grid, have values of their own; others only have a sign.
constexpr int kBand = 3;

class Sweeper {
 public:
  Sweeper(const PlaneGrid& grid, const SlicePair& slices, double height_mm)
      : grid_(grid),
        slices_(slices),
        height_mm_(static_cast<float>(height_mm)),
        parts_(swept_parts(grid, slices)),
        claimed_(grid.size(), false) {}

  FrontSweep run() {
    out_.speed.resize(grid_.size());
    for (std::size_t n = 0; n < grid_.size(); ++n) out_.speed[n] = (upper(n) - lower(n)) / height_mm_;
    FrontArrival arrival(grid_, slices_);
    for (std::uint32_t p = 0; p < parts_.parts.size(); ++p) {
      if (parts_.parts[p].alone())
        end(parts_.parts[p]);
      else
        sweep(parts_.parts[p], arrival.over(parts_, p));
    }
    // Elsewhere near contours they are near each other, or the front stands still or is far.
    const float band_mm = kBand * static_cast<float>(grid_.spacing_mm);
    for (std::size_t n = 0; n < grid_.size(); ++n)
      if (!claimed_[n] && std::min(std::abs(lower(n)), std::abs(upper(n))) < band_mm)
        add(static_cast<std::uint32_t>(n), FrontNode::Course::between, lower(n), upper(n) - lower(n));
    return std::move(out_);
  }

 private:
  [[nodiscard]] float lower(std::size_t node) const { return (*slices_.lower)[node]; }
  [[nodiscard]] float upper(std::size_t node) const { return (*slices_.upper)[node]; }

  void add(std::uint32_t node, FrontNode::Course course, float start_mm, float change_mm) {
    claimed_[node] = true;
    out_.nodes.push_back({node, course, start_mm, change_mm, {}});
  }

  void sweep(const SweptPart& part, const std::vector<NodeArrival>& arrivals) {
    for (std::size_t i = 0; i < part.nodes.size(); ++i) {
      const float change = (part.in_lower ? -1 : 1) / arrivals[i].per_mm;
      add(part.nodes[i], FrontNode::Course::between, -arrivals[i].way * change, change);
    }
  }

  /// The front shrinks to nothing on its way from the one contour that the part has.
  void end(const SweptPart& part) {
    const bool is_lower = part.on_upper == 0, solid = is_lower == part.in_lower;
    const std::vector<float>&own = is_lower ? *slices_.lower : *slices_.upper,
          &other = is_lower ? *slices_.upper : *slices_.lower;
    float radius_mm = 0;
    for (const std::uint32_t n : part.nodes) radius_mm = std::max(radius_mm, std::abs(own[n]));
    if (radius_mm < static_cast<float>(grid_.spacing_mm)) return;  // finer than is drawn: left to near contours
    const float change = solid ? -radius_mm : radius_mm, speed = change / (kEnd * height_mm_);
    const auto inward = [&](std::uint32_t n) { return solid ? own[n] : -own[n]; };
    spread(
        part, std::numeric_limits<int>::max(),
        [&](std::uint32_t from, std::uint32_t to) {
          return inward(to) < inward(from);  // as long as this is the nearest contour
        },
        [&](std::uint32_t n) { out_.speed[n] = is_lower ? speed : -speed; });
    spread(
        part, kBand,
        [&](std::uint32_t, std::uint32_t to) {
          return parts_.part_of[to] == kNotSwept && !claimed_[to] && std::abs(own[to]) <= std::abs(other[to]);
        },
        [&](std::uint32_t n) {
          add(n, is_lower ? FrontNode::Course::from_lower : FrontNode::Course::from_upper, own[n], change);
        });
    Unmatched& unmatched = is_lower ? out_.in_lower : out_.in_upper;
    ++(solid ? unmatched.parts : unmatched.holes);
    unmatched.area_mm2 += static_cast<double>(part.nodes.size()) * grid_.spacing_mm * grid_.spacing_mm;
  }

  /// Visits the part's nodes and, ring by ring, those around it that may be entered from their neighbours.
  template <class MayEnter, class Visit>
  void spread(const SweptPart& part, int rings, MayEnter may_enter, Visit visit) const {
    const std::array<std::ptrdiff_t, 4> steps{-1, 1, -std::ptrdiff_t{grid_.width}, std::ptrdiff_t{grid_.width}};
    std::vector<bool> seen(grid_.size(), false);
    const auto is_outermost = [&](std::uint32_t node) {
      const Eigen::Vector2i at = grid_.node(node);
      return at.minCoeff() == 0 || at.x() == grid_.width - 1 || at.y() == grid_.height - 1;
    };
    std::vector<std::uint32_t> ring = part.nodes;
    for (const std::uint32_t node : ring) seen[node] = true;
    for (int i = 0;; ++i) {
      for (const std::uint32_t node : ring) visit(node);
      if (i == rings || ring.empty()) return;
      std::vector<std::uint32_t> next;
      for (const std::uint32_t node : ring)
        for (const std::ptrdiff_t step : steps) {
          const auto beside = static_cast<std::uint32_t>(static_cast<std::ptrdiff_t>(node) + step);
          if (seen[beside] || is_outermost(beside) || !may_enter(node, beside)) continue;
          seen[beside] = true;
          next.push_back(beside);
        }
      ring = std::move(next);
    }
  }

  const PlaneGrid& grid_;
  SlicePair slices_;
  float height_mm_;
  SweptParts parts_;
  std::vector<bool> claimed_;
  FrontSweep out_;
};

}  // namespace

FrontSweep sweep_between(const PlaneGrid& grid, const SlicePair& slices, double height_mm) {
  return Sweeper(grid, slices, height_mm).run();
}

}  // namespace sonoloft
