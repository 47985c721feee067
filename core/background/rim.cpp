#include "core/background/rim.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sonoloft {
namespace {

constexpr double kReach = 8;           ///< spacings, as far as the background remembers
constexpr double kLongestPiece = 2;    ///< spacings
constexpr double kEnclosed = 20;       ///< what a border around a shadow weighs, against others
constexpr float kLeastCross = 1e-20f;  ///< mm^2 over pieces: keeps weights on the border finite

constexpr std::size_t kLanes = 8;
using Lanes = std::array<float, kLanes>;

/// Only edges with something known on one side count.
bool is_border(const SectionEdge& e) {
  return (e.left == kUnknown) != (e.right == kUnknown);
}

/// The borders that hang together, by point of the section, and the area that each has around it, twice: positive
/// where the unknown part is inside.
class Loops {
 public:
  explicit Loops(const Section& section) : parent_(section.points.size()), area_(section.points.size(), 0.0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (const SectionEdge& e : section.edges)
      if (is_border(e)) parent_[root(e.a)] = root(e.b);
    for (const SectionEdge& e : section.edges) {
      if (!is_border(e)) continue;
      const Eigen::Vector2d &a = section.points[e.a], &b = section.points[e.b];
      area_[root(e.a)] += (e.left == kUnknown ? 1 : -1) * (a.x() * b.y() - a.y() * b.x());
    }
  }
  [[nodiscard]] bool encloses_shadow(const SectionEdge& e) { return area_[root(e.a)] > 0; }

 private:
  std::uint32_t root(std::uint32_t point) {
    while (parent_[point] != point) point = parent_[point] = parent_[parent_[point]];
    return point;
  }
  std::vector<std::uint32_t> parent_;
  std::vector<double> area_;
};

}  // namespace

Rim::Rim(const Section& section, double spacing_mm)
    : reference_to_image_(section.image_to_reference.inverse(Eigen::Isometry)), reach_mm_(kReach * spacing_mm) {
  for (const SectionEdge& e : section.edges)
    if (is_border(e)) labels_.push_back(e.left == kUnknown ? e.right : e.left);
  std::sort(labels_.begin(), labels_.end());
  labels_.erase(std::unique(labels_.begin(), labels_.end()), labels_.end());
  Loops loops(section);
  for (const SectionEdge& e : section.edges) {
    if (!is_border(e)) continue;
    const Label label = e.left == kUnknown ? e.right : e.left;
    const auto index = std::lower_bound(labels_.begin(), labels_.end(), label) - labels_.begin();
    const auto scale = static_cast<float>((loops.encloses_shadow(e) ? kEnclosed : 1.0) * spacing_mm);
    const Eigen::Vector2d &from = section.points[e.a], &to = section.points[e.b];
    const double parts = std::ceil((to - from).norm() / (kLongestPiece * spacing_mm));
    for (double i = 0; i < parts; ++i) {
      const Eigen::Vector2f a = (from + (to - from) * (i / parts)).cast<float>();
      const Eigen::Vector2f b = (from + (to - from) * ((i + 1) / parts)).cast<float>();
      pieces_.push_back({a.x(), a.y(), b.x(), b.y(), scale, static_cast<std::uint32_t>(index)});
    }
  }
  sort_into_tiles();
}

Eigen::Array2i Rim::tile_of(const Eigen::Vector2d& point) const {
  const Eigen::Array2d tile = ((point - tiles_.origin) / reach_mm_).array().floor();
  return tile.max(0.0).min((tiles_.count - 1).cast<double>()).cast<int>();
}

void Rim::sort_into_tiles() {
  if (pieces_.empty()) return;
  const auto middle = [](const Piece& p) {
    return Eigen::Vector2d(0.5 * (double{p.ax} + double{p.bx}), 0.5 * (double{p.ay} + double{p.by}));
  };
  Eigen::AlignedBox2d bounds;
  for (const Piece& p : pieces_) bounds.extend(middle(p));
  tiles_.origin = bounds.min();
  tiles_.count = (bounds.sizes() / reach_mm_).array().floor().cast<int>() + 1;
  const auto tile = [&](const Piece& p) {
    const Eigen::Array2i at = tile_of(middle(p));
    return static_cast<std::size_t>(at.y() * tiles_.count.x() + at.x());
  };
  std::stable_sort(pieces_.begin(), pieces_.end(), [&](const Piece& l, const Piece& r) { return tile(l) < tile(r); });
  tiles_.first.assign(static_cast<std::size_t>(tiles_.count.prod()) + 1, 0);
  for (const Piece& p : pieces_) ++tiles_.first[tile(p) + 1];
  std::partial_sum(tiles_.first.begin(), tiles_.first.end(), tiles_.first.begin());
}

template <class Visit>
void Rim::for_each_run(const Eigen::Vector3d& centre, double radius_mm, Visit visit) const {
  const Eigen::Vector3d at = reference_to_image_ * centre;
  const double reach = reach_mm_ + radius_mm, across2 = reach * reach - at.z() * at.z();
  if (pieces_.empty() || across2 <= 0) return;
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(std::sqrt(across2) * 1.0001);
  const Eigen::Vector2d low = at.head<2>() - half, high = at.head<2>() + half;
  const Eigen::Vector2d end = tiles_.origin + reach_mm_ * tiles_.count.cast<double>().matrix();
  if ((high.array() < tiles_.origin.array()).any() || (low.array() > end.array()).any()) return;
  const Eigen::Array2i first = tile_of(low), last = tile_of(high);
  for (int y = first.y(); y <= last.y(); ++y) {
    const auto row = static_cast<std::size_t>(y * tiles_.count.x());
    visit(tiles_.first[row + static_cast<std::size_t>(first.x())],
          tiles_.first[row + static_cast<std::size_t>(last.x()) + 1]);
  }
}

bool Rim::reaches(const Eigen::Vector3d& centre_mm, double radius_mm) const {
  bool any = false;
  for_each_run(centre_mm, radius_mm, [&](std::uint32_t first, std::uint32_t last) { any |= first < last; });
  return any;
}

void Rim::weigh(std::span<const Eigen::Vector3d> points_mm, PointWeights& out) const {
  out.labels = labels_;
  out.weight.assign(labels_.size() * points_mm.size(), 0.0f);
  const auto inverse_reach2 = static_cast<float>(1 / (reach_mm_ * reach_mm_));
  std::array<std::size_t, kLanes> index;
  std::vector<Lanes> sums(labels_.size());
  for (std::size_t start = 0; start < points_mm.size(); start += kLanes) {
    Lanes px, py, h2;
    Eigen::AlignedBox3d bounds;
    for (std::size_t i = 0; i < kLanes; ++i) {
      index[i] = std::min(start + i, points_mm.size() - 1);
      bounds.extend(points_mm[index[i]]);
      const Eigen::Vector3f p = (reference_to_image_ * points_mm[index[i]]).cast<float>();
      px[i] = p.x();
      py[i] = p.y();
      h2[i] = p.z() * p.z();
    }
    for (Lanes& sum : sums) sum.fill(0);
    for_each_run(bounds.center(), 0.5 * bounds.diagonal().norm(), [&](std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t k = first; k < last; ++k) {
        const Piece& e = pieces_[k];
        const float ex = e.bx - e.ax, ey = e.by - e.ay, length2 = ex * ex + ey * ey;
        const float mx = 0.5f * (e.ax + e.bx), my = 0.5f * (e.ay + e.by);
        Lanes& sum = sums[e.label];
        for (std::size_t i = 0; i < kLanes; ++i) {
          const float dx = mx - px[i], dy = my - py[i], d2 = (dx * dx + dy * dy + h2[i]) * inverse_reach2;
          const float fade = std::max(1 - d2 * d2, 0.0f);
          const float ax = e.ax - px[i], ay = e.ay - py[i], bx = e.bx - px[i], by = e.by - py[i];
          const float flat = ax * by - ay * bx, cross2 = std::max(flat * flat + h2[i] * length2, kLeastCross);
          const float cross = std::sqrt(cross2), dot = ax * bx + ay * by + h2[i];
          const float ra = std::sqrt(ax * ax + ay * ay + h2[i]), rb = std::sqrt(bx * bx + by * by + h2[i]);
          // The integral is cross (ra + rb) / (ra rb (ra rb + dot)); cross^2 = (ra rb + dot) (ra rb - dot), and the
          // factor that does not cancel is the one to use.
          const float product = std::max(ra * rb, kLeastCross), sharp = product + std::abs(dot);
          const float numerator = dot < 0 ? sharp : cross, denominator = dot < 0 ? cross : sharp;
          sum[i] += fade * fade * e.scale * (ra + rb) * numerator / (product * denominator);
        }
      }
    });
    for (std::size_t l = 0; l < labels_.size(); ++l)
      for (std::size_t i = 0; i < kLanes; ++i) out.weight[l * points_mm.size() + index[i]] = sums[l][i];
  }
}

}  // namespace sonoloft
