#include "device_sim/probe/phantoms/section_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "device_sim/probe/phantoms/label_network.h"

namespace sonoloft::device_sim {
namespace {

using LabelInPlane = std::function<Label(const Eigen::Vector2d&)>;

/// Corners 0..3 and sides 0..3 of a square run counter-clockwise; side k joins corner k and k + 1.
constexpr std::array<std::array<int, 2>, 4> kCorner = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
using Corners = std::array<Label, 4>;

int distinct(const Corners& c) {
  return 1 + (c[1] != c[0]) + (c[2] != c[0] && c[2] != c[1]) + (c[3] != c[0] && c[3] != c[1] && c[3] != c[2]);
}

/// The point of a square where most labels meet.
Eigen::Vector2d locate_junction(Eigen::Vector2d origin, double size, Corners c, const LabelInPlane& label_at) {
  constexpr int kHalvings = 24;
  for (int step = 0; step < kHalvings; ++step) {
    const double half = size / 2;
    std::array<std::array<Label, 3>, 3> l;  // [y][x]
    for (std::size_t k = 0; k < 4; ++k)
      l[2 * static_cast<std::size_t>(kCorner[k][1])][2 * static_cast<std::size_t>(kCorner[k][0])] = c[k];
    for (const auto& [x, y] : {std::array{1, 0}, {0, 1}, {1, 1}, {2, 1}, {1, 2}})
      l[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = label_at(origin + half * Eigen::Vector2d(x, y));
    Corners best{};
    std::size_t best_quarter = 0;
    int most = 2;
    for (std::size_t q = 0; q < 4; ++q) {
      const auto x = static_cast<std::size_t>(kCorner[q][0]), y = static_cast<std::size_t>(kCorner[q][1]);
      const Corners quarter = {l[y][x], l[y][x + 1], l[y + 1][x + 1], l[y + 1][x]};
      if (distinct(quarter) <= most) continue;
      most = distinct(quarter);
      best = quarter;
      best_quarter = q;
    }
    if (most < 3) break;  // it hides within a quarter that shows two labels only: its place is known to half a square
    origin += half * Eigen::Vector2d(kCorner[best_quarter][0], kCorner[best_quarter][1]);
    size = half;
    c = best;
  }
  return origin + Eigen::Vector2d::Constant(size / 2);
}

/// One run over the grid of a section.
class Tracer {
 public:
  Tracer(const Eigen::AlignedBox2d& area, double spacing_mm, const LabelInPlane& label_at)
      : label_at_(label_at), h_(std::max(spacing_mm, area.sizes().maxCoeff() / kMaxLines)) {
    origin_ = area.min() - Eigen::Vector2d::Constant(h_);
    nx_ = static_cast<std::size_t>(std::ceil(area.sizes().x() / h_)) + 3;
    ny_ = static_cast<std::size_t>(std::ceil(area.sizes().y() / h_)) + 3;
    labels_.assign(nx_ * ny_, kOutside);  // stays so on the rim: every border closes
    for (std::size_t y = 1; y + 1 < ny_; ++y)
      for (std::size_t x = 1; x + 1 < nx_; ++x) labels_[y * nx_ + x] = label_at_(node(x, y));
  }

  PhantomSection run() {
    add_crossings();
    for (std::size_t y = 0; y + 1 < ny_; ++y)
      for (std::size_t x = 0; x + 1 < nx_; ++x) add_square(x, y);
    return network_.loops(h_);
  }

 private:
  static constexpr double kMaxLines = 4096;

  [[nodiscard]] Eigen::Vector2d node(std::size_t x, std::size_t y) const {
    return origin_ + h_ * Eigen::Vector2d(static_cast<double>(x), static_cast<double>(y));
  }

  /// The border on the way from p to q. Bisects for the smaller label: the answer is the same from both ends.
  [[nodiscard]] Eigen::Vector2d crossing(Eigen::Vector2d p, Label p_label, Eigen::Vector2d q, Label q_label) const {
    constexpr int kHalvings = 20;
    if (q_label < p_label) std::swap(p, q);
    const Label smaller = std::min(p_label, q_label);
    for (int i = 0; i < kHalvings; ++i) {
      const Eigen::Vector2d middle = (p + q) / 2;
      (label_at_(middle) == smaller ? p : q) = middle;
    }
    return (p + q) / 2;
  }

  void add_crossings() {
    across_.assign(2 * nx_ * ny_, 0);
    for (std::size_t y = 0; y + 1 < ny_; ++y) {
      for (std::size_t x = 0; x + 1 < nx_; ++x) {
        const std::size_t i = y * nx_ + x;
        const Label l = labels_[i], right = labels_[i + 1], up = labels_[i + nx_];
        if (l != right) across_[2 * i] = network_.add_vertex(crossing(node(x, y), l, node(x + 1, y), right));
        if (l != up) across_[2 * i + 1] = network_.add_vertex(crossing(node(x, y), l, node(x, y + 1), up));
      }
    }
  }

  void add_square(std::size_t x, std::size_t y) {
    const std::size_t i = y * nx_ + x;
    const Corners c = {labels_[i], labels_[i + 1], labels_[i + nx_ + 1], labels_[i + nx_]};
    if (c[0] == c[1] && c[0] == c[2] && c[0] == c[3]) return;
    const std::array<std::uint32_t, 4> on_side = {across_[2 * i], across_[2 * (i + 1) + 1], across_[2 * (i + nx_)],
                                                  across_[2 * i + 1]};
    std::array<std::uint32_t, 4> ends;
    std::array<Label, 4> after;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (c[k] == c[(k + 1) % 4]) continue;
      ends[count] = on_side[k];
      after[count++] = c[(k + 1) % 4];
    }
    if (count == 2) return network_.add_segment(ends[0], ends[1], after[1], after[0]);
    if (count == 4 && (c[0] == c[2] || c[1] == c[3]) && cut_corners(c, on_side, x, y)) return;
    network_.add_junction(locate_junction(node(x, y), h_, c, label_at_), {ends.data(), count}, {after.data(), count});
  }

  /// Two opposite corners of one label: where their label rules the middle as well, they are joined and the other two
  /// are cut off.
  bool cut_corners(const Corners& c, const std::array<std::uint32_t, 4>& on_side, std::size_t x, std::size_t y) {
    const Label middle = label_at_(node(x, y) + Eigen::Vector2d::Constant(h_ / 2));
    const bool joined[2] = {c[0] == c[2] && c[0] == middle, c[1] == c[3] && c[1] == middle};
    if (!joined[0] && !joined[1]) return false;
    for (std::size_t k = joined[0] ? 1 : 0; k < 4; k += 2)
      network_.add_segment(on_side[(k + 3) % 4], on_side[k], middle, c[k]);
    return true;
  }

  const LabelInPlane& label_at_;
  double h_;
  Eigen::Vector2d origin_;
  std::size_t nx_ = 0, ny_ = 0;
  std::vector<Label> labels_;          ///< [nx * ny] x fastest
  std::vector<std::uint32_t> across_;  ///< [2 nx * ny] vertex on the way from node i to its right; to the one above
  LabelNetwork network_;
};

}  // namespace

PhantomSection trace_section(const Eigen::AlignedBox2d& area, double spacing_mm, const LabelInPlane& label_at) {
  if (area.isEmpty()) return {};
  return Tracer(area, spacing_mm, label_at).run();
}

Eigen::AlignedBox2d section_area(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& plane_to_reference) {
  Eigen::AlignedBox2d area;
  for (const Eigen::Vector2d& corner : box_section(box, plane_to_reference)) area.extend(corner);
  return area;
}

PhantomSection trace_section(const Eigen::AlignedBox2d& area, const Eigen::Isometry3d& plane_to_reference,
                             double spacing_mm, const std::function<Label(const Eigen::Vector3d&)>& label_at) {
  const Eigen::Vector3d origin = plane_to_reference.translation();
  const Eigen::Vector3d x_axis = plane_to_reference.linear().col(0), y_axis = plane_to_reference.linear().col(1);
  return trace_section(area, spacing_mm,
                       [&](const Eigen::Vector2d& p) { return label_at(origin + p.x() * x_axis + p.y() * y_axis); });
}

}  // namespace sonoloft::device_sim
