#include "core/field/packing/stretches.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace sonoloft {
namespace {

using kernels::PackedStretch;
using kernels::PackedVertex;
using kernels::u32;

constexpr std::size_t kShortChain = 16, kShortStretch = 8;  ///< edges, measured: below that halving costs more
constexpr double kLeastStraightness = 0.5;                  ///< chord over length of a stretch that two edges stand for
constexpr double kLeastDistance = 2;                        ///< in radii of the stretch, wherever its moments vanish

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}
Eigen::Vector2d at(const PackedVertex& v) {
  return {v.x, v.y};
}
Eigen::Vector2d outward(const PackedVertex& v) {
  return {v.outward_x, v.outward_y};
}

class Segment {
 public:
  Segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b) : a_(a), along_(b - a) {
    const double length2 = along_.squaredNorm();
    per_length2_ = length2 > 0 ? 1 / length2 : 0;
  }
  [[nodiscard]] double squared_distance(const Eigen::Vector2d& p) const {
    const double t = std::clamp((p - a_).dot(along_) * per_length2_, 0.0, 1.0);
    return (p - a_ - t * along_).squaredNorm();
  }

 private:
  Eigen::Vector2d a_, along_;
  double per_length2_;
};

/// Of the area that points enclose, one after the other: its size and, over that, its centre.
struct Area {
  double size = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();

  void add_edge(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const double part = cross(a, b) / 2;
    size += part;
    moment += part / 3 * (a + b);
  }
};

/// A chain of 2 edges or more and what may stand for it: a, middle, b.
class Stretch {
 public:
  /// @param steps  [chain] lengths of the edges; the last is not read
  Stretch(std::span<const PackedVertex> chain, std::span<const double> steps)
      : chain_(chain), steps_(steps), a_(at(chain.front())), b_(at(chain.back())) {
    Eigen::Vector2d low = a_, high = a_;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      low = low.cwiseMin(at(chain[i])), high = high.cwiseMax(at(chain[i]));
      length_ += steps[i - 1];
      area_.add_edge(at(chain[i - 1]) - a_, at(chain[i]) - a_);
    }
    centre_ = (low + high) / 2;
    radius_ = (high - low).norm() / 2;
    chord_ = (b_ - a_).norm();
  }

  [[nodiscard]] PackedStretch packed() {
    PackedStretch stretch{};
    stretch.x = static_cast<float>(centre_.x()), stretch.y = static_cast<float>(centre_.y());
    stretch.least2 = std::numeric_limits<float>::infinity();
    if (!(chord_ > kLeastStraightness * length_)) return stretch;
    find_middle();
    if (!move_middle()) return stretch;
    stretch.middle = middle_;
    bound(stretch);
    return stretch;
  }

 private:
  /// Where the triangle a, middle, b has the area and, along the chord, the centre of what is between chord and chain.
  void find_middle() {
    along_ = (b_ - a_) / chord_;
    const double centre = area_.moment.dot(along_);
    double t = 0.5;
    if (std::abs(area_.size) > 1e-3 * chord_ * chord_) t = std::clamp(3 * centre / area_.size / chord_ - 1, 0.1, 0.9);
    m_ = a_ + t * chord_ * along_ - 2 * area_.size / chord_ * normal();
    middle_.x = static_cast<float>(m_.x()), middle_.y = static_cast<float>(m_.y());
    radius_ = std::max(radius_, (m_ - centre_).norm());
  }

  /// What the area gains as vertices move, less what it gains by a and b alone, is what the middle has to give.
  bool move_middle() {
    double gain = 0, slope = 0, curvature = 0, fading4 = 0;
    const auto add = [&](const PackedVertex& v, const Eigen::Vector2d& across) {
      const double g = cross(outward(v), across) / 2;
      gain += g, slope += g * v.slope, curvature += g * v.curvature;
    };
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      const Eigen::Vector2d before = i == 0 ? m_ : at(chain_[i - 1]),
                            after = i + 1 < chain_.size() ? at(chain_[i + 1]) : m_;
      add(chain_[i], after - before);
      fading4 += chain_[i].fading4;
    }
    if (!(std::abs(gain) > 0.1 * chord_)) return false;
    const Eigen::Vector2d out = -2 * gain / chord_ * normal();
    middle_.outward_x = static_cast<float>(out.x()), middle_.outward_y = static_cast<float>(out.y());
    middle_.slope = static_cast<float>(slope / gain), middle_.curvature = static_cast<float>(curvature / gain);
    middle_.fading4 = static_cast<float>(fading4 / static_cast<double>(chain_.size()));
    return true;
  }

  /// From where it may stand. The kernel h / r^4 over what lies between the chain and the two edges, expanded around
  /// the centre: its area vanishes, its first moment counts 4 / r^5, its second 12 / r^6, each times h < r. What moves
  /// otherwise than the line from a by the middle to b does adds a first moment that grows with h.
  void bound(PackedStretch& stretch) const {
    const Segment first(a_, m_), second(m_, b_);
    const double per_length = 1 / length_;
    double off2 = 0, slope_off = 0, curvature_off = 0, passed = 0;
    Area between;
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      const bool is_last = i + 1 == chain_.size();
      const Eigen::Vector2d p = at(chain_[i]), next = is_last ? m_ : at(chain_[i + 1]);
      const double step = is_last ? 0 : steps_[i] * per_length;
      between.add_edge(p - centre_, next - centre_);
      off2 = std::max(off2, std::min(first.squared_distance(p), second.squared_distance(p)));
      slope_off += step * std::abs(chain_[i].slope - line(passed, &PackedVertex::slope));
      curvature_off += step * std::abs(chain_[i].curvature - line(passed, &PackedVertex::curvature));
      passed += step;
    }
    between.add_edge(m_ - centre_, a_ - centre_);
    const double least = kLeastDistance * radius_;
    stretch.least2 = static_cast<float>(least * least);
    stretch.rest = static_cast<float>(4 * between.moment.norm() + 12 * std::sqrt(off2) * length_ * radius_);
    stretch.sway = static_cast<float>(4 * slope_off * length_ * radius_);
    stretch.bow = static_cast<float>(2 * curvature_off * length_ * radius_);
  }

  /// @param t  share of the way from a to b
  [[nodiscard]] double line(double t, float PackedVertex::*value) const {
    const double a = chain_.front().*value, m = middle_.*value, b = chain_.back().*value;
    return t < 0.5 ? a + 2 * t * (m - a) : m + (2 * t - 1) * (b - m);
  }
  [[nodiscard]] Eigen::Vector2d normal() const { return {-along_.y(), along_.x()}; }

  std::span<const PackedVertex> chain_;
  std::span<const double> steps_;
  Eigen::Vector2d a_, b_, centre_, along_, m_;
  double length_ = 0, chord_ = 0, radius_ = 0;
  Area area_;  ///< between the chord and the chain, seen from a
  PackedVertex middle_{};
};

}  // namespace

void add_stretches(const std::vector<PackedVertex>& vertices, std::size_t first,
                   std::vector<PackedStretch>& stretches) {
  if (vertices.size() - first <= kShortChain) return;
  std::vector<double> steps(vertices.size() - first);
  for (std::size_t i = 0; i + 1 < steps.size(); ++i)
    steps[i] = (at(vertices[first + i + 1]) - at(vertices[first + i])).norm();
  const std::size_t base = stretches.size();
  const auto halve = [&](const auto& self, std::size_t begin, std::size_t count) -> void {
    const std::size_t own = stretches.size();
    stretches.push_back(
        Stretch(std::span(vertices).subspan(begin, count + 1), std::span(steps).subspan(begin - first, count + 1))
            .packed());
    stretches[own].first = static_cast<u32>(begin), stretches[own].count = static_cast<u32>(count);
    if (count > kShortStretch) {
      self(self, begin, count / 2);
      self(self, begin + count / 2, count - count / 2);
    }
    stretches[own].next = static_cast<u32>(stretches.size() - base);
  };
  halve(halve, first, vertices.size() - first - 1);
}

}  // namespace sonoloft
