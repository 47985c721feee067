#include "core/completion/plane_regions.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sonoloft {
namespace {

/// Ends of borders that are nearer than this share of the least height are the same.
constexpr double kSameEnd = 1e-3;
/// Angles with a tangent of up to 1/4 are summed as a series: off by less than 10^-12 of themselves.
constexpr double kNarrow = 1.0 / 16;

/// atan(t) / t by its series in t^2.
double narrow_quotient(double t2) {
  double sum = 1.0 / 17;
  for (int odd = 15; odd > 0; odd -= 2) sum = 1.0 / odd - t2 * sum;
  return sum;
}

}  // namespace

void normalise(std::span<PointLanes> weights) {
  for (std::size_t i = 0; i < kPointLanes; ++i) {
    double total = 0;
    for (PointLanes& lanes : weights) total += lanes[i] = std::max(lanes[i], 0.0);  // below 0 by rounding
    for (PointLanes& lanes : weights) lanes[i] = total > 0 ? lanes[i] / total : 0;
    if (!(total > 0)) weights[0][i] = 1;
  }
}

PointBlock::PointBlock(std::span<const Eigen::Vector3d> points, std::size_t first) {
  for (std::size_t i = 0; i < kPointLanes; ++i) {
    const Eigen::Vector3d& p = points[std::min(first + i, points.size() - 1)];
    x[i] = p.x();
    y[i] = p.y();
    z[i] = p.z();
  }
}

void PlaneRegions::add(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::uint32_t slot,
                       const LinearShare& share) {
  const double step_mm = kSameEnd * min_height_mm_;
  const auto rounded = [&](double mm) { return static_cast<std::int64_t>(std::llround(mm / step_mm)); };
  const std::array<std::int64_t, 2> from{rounded(a.x()), rounded(a.y())}, to{rounded(b.x()), rounded(b.y())};
  if (from < to)
    pieces_.push_back({{from[0], from[1], to[0], to[1]}, a, b, slot, share});
  else if (to < from)
    pieces_.push_back({{to[0], to[1], from[0], from[1]}, b, a, slot, {-share.value, -share.gradient}});
}

void PlaneRegions::finish() {
  std::stable_sort(pieces_.begin(), pieces_.end(),
                   [](const Piece& l, const Piece& r) { return std::tie(l.key, l.slot) < std::tie(r.key, r.slot); });
  for (std::size_t i = 0; i < pieces_.size();) {
    const Piece& first = pieces_[i];
    const Eigen::Vector2d along = first.b - first.a;
    Border border{first.a.x(), first.a.y(), along.x(), along.y(), along.squaredNorm(), 0, 0};
    border.first_term = static_cast<std::uint32_t>(terms_.size());
    while (i < pieces_.size() && pieces_[i].key == first.key) {
      Term term{pieces_[i].slot, {}};
      for (; i < pieces_.size() && pieces_[i].key == first.key && pieces_[i].slot == term.slot; ++i) {
        term.share.value += pieces_[i].share.value;
        term.share.gradient += pieces_[i].share.gradient;
      }
      if (term.share.value != 0.0 || !term.share.gradient.isZero(0.0)) terms_.push_back(term);
    }
    border.term_count = static_cast<std::uint32_t>(terms_.size()) - border.first_term;
    if (border.term_count > 0) borders_.push_back(border);
  }
  pieces_ = {};
}

void PlaneRegions::weigh(const PointBlock& block, std::span<PointLanes> sums) const {
  PointLanes px, py, h, h2, half_inverse_h;
  for (std::size_t i = 0; i < kPointLanes; ++i) {
    const Eigen::Vector3d p = reference_to_image_ * Eigen::Vector3d(block.x[i], block.y[i], block.z[i]);
    px[i] = p.x();
    py[i] = p.y();
    h[i] = std::max(std::abs(p.z()), min_height_mm_);
    h2[i] = h[i] * h[i];
    half_inverse_h[i] = 0.5 / h[i];
  }
  for (const Border& e : borders_) {
    PointLanes cross, w2, v, q;
    int wide = 0;
    for (std::size_t i = 0; i < kPointLanes; ++i) {
      const double ax = e.x - px[i], ay = e.y - py[i];
      cross[i] = ax * e.along_y - ay * e.along_x;
      w2[i] = cross[i] * cross[i] + e.length2 * h2[i];
      v[i] = ax * (ax + e.along_x) + ay * (ay + e.along_y) + h2[i];
      const double inverse = 1.0 / v[i];
      q[i] = inverse * narrow_quotient(w2[i] * inverse * inverse);
      wide += static_cast<int>(v[i] <= 0.0) | static_cast<int>(w2[i] > kNarrow * v[i] * v[i]);
    }
    if (wide > 0)
      for (std::size_t i = 0; i < kPointLanes; ++i)
        if (v[i] <= 0.0 || w2[i] > kNarrow * v[i] * v[i]) {
          const double w = std::sqrt(w2[i]);
          q[i] = std::atan2(w, v[i]) / w;
        }
    for (std::uint32_t t = e.first_term; t < e.first_term + e.term_count; ++t) {
      const LinearShare& share = terms_[t].share;
      const double gx = share.gradient.x(), gy = share.gradient.y();
      const double turn = 0.5 * (gx * e.along_y - gy * e.along_x);
      PointLanes& sum = sums[terms_[t].slot];
      for (std::size_t i = 0; i < kPointLanes; ++i)
        sum[i] += q[i] * ((share.value + gx * px[i] + gy * py[i]) * cross[i] * half_inverse_h[i] - h[i] * turn);
    }
  }
}

}  // namespace sonoloft
