#include "core/slice/section_raster.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace sonoloft {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// a b - c d with the right sign and no false zero. Source: Kahan; Jeannerod, Louvet, Muller 2013.
double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

/// Positive when p lies left of a -> b; exact, since points lie on one grid.
double orient(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return difference_of_products(b.x() - a.x(), p.y() - a.y(), b.y() - a.y(), p.x() - a.x());
}

/// Where a row of pixels meets a border.
struct Crossing {
  double x;
  const Vector2d *low, *high;  ///< the border's ends
  Label beyond;                ///< on the side of larger x
};

class Rasterizer {
 public:
  Rasterizer(const Section& section, double spacing_mm, const Eigen::AlignedBox3d& box) : section_(section), box_(box) {
    out_.spacing_mm = spacing_mm;
    for (const Vector2d& p : section.points) unsure_mm_ = std::max(unsure_mm_, 1e-14 * p.cwiseAbs().maxCoeff());
  }

  SectionRaster run() {
    if (!place_frame()) return out_;
    out_.label.assign(static_cast<std::size_t>(out_.width) * static_cast<std::size_t>(out_.height), kUnknown);
    collect_crossings();
    for (int y = 1; y + 1 < out_.height; ++y) fill_row(y);
    return out_;
  }

 private:
  /// Pixels of all points that may be known and in the box, and one more on every side.
  bool place_frame() {
    const Eigen::Isometry3d to_image = section_.image_to_reference.inverse(Eigen::Isometry);
    Eigen::AlignedBox3d reach;
    for (int corner = 0; corner < 8; ++corner)
      reach.extend(to_image * box_.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
    if (reach.min().z() > 0 || reach.max().z() < 0) return false;
    Eigen::AlignedBox2d part(reach.min().head<2>(), reach.max().head<2>());
    if (section_.border == kUnknown) {
      Eigen::AlignedBox2d known;
      for (const Vector2d& p : section_.points) known.extend(p);
      part = part.intersection(known);
    }
    if (part.isEmpty()) return false;
    out_.first = (part.min() / out_.spacing_mm).array().floor() - 1.0;
    const Vector2d count = (part.max() / out_.spacing_mm).array().floor() + 2.0 - out_.first.array();
    assert(count.maxCoeff() < 1e5);
    out_.width = static_cast<int>(count.x());
    out_.height = static_cast<int>(count.y());
    return true;
  }

  /// The rows 1 .. height - 2 that a border meets, by  low <= y < high.
  template <class Visit>
  void for_each_row(const SectionEdge& edge, Visit visit) const {
    const auto [low, high] = std::minmax(section_.points[edge.a].y(), section_.points[edge.b].y());
    const auto row_of = [&](double y) { return std::floor(y / out_.spacing_mm - out_.first.y()); };
    // Rounding may be off by one row: the comparison below decides.
    const int from = static_cast<int>(std::clamp(row_of(low) - 1, 1.0, out_.height - 1.0));
    const int to = static_cast<int>(std::clamp(row_of(high) + 1, 0.0, out_.height - 2.0));
    for (int row = from; row <= to; ++row)
      if (const double y = out_.point(0, row).y(); low <= y && y < high) visit(row, y);
  }

  /// By row, counted first and then put in their places.
  void collect_crossings() {
    begin_.assign(static_cast<std::size_t>(out_.height) + 1, 0);
    for (const SectionEdge& e : section_.edges)
      for_each_row(e, [&](int row, double) { ++begin_[static_cast<std::size_t>(row) + 1]; });
    for (std::size_t row = 1; row < begin_.size(); ++row) begin_[row] += begin_[row - 1];
    crossings_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const SectionEdge& e : section_.edges) {
      const Vector2d &a = section_.points[e.a], &b = section_.points[e.b];
      const bool up = a.y() < b.y();
      for_each_row(e, [&](int row, double y) {
        const double x = a.x() + (b.x() - a.x()) * ((y - a.y()) / (b.y() - a.y()));
        crossings_[next[static_cast<std::size_t>(row)]++] = {x, up ? &a : &b, up ? &b : &a, up ? e.right : e.left};
      });
    }
  }

  /// Of two borders that one row meets. Where rounding could decide, of that with the higher lower end its ends do.
  bool is_left(const Crossing& c, const Crossing& d) const {
    if (std::abs(c.x - d.x) > unsure_mm_) return c.x < d.x;
    if (c.low->y() > d.low->y()) return side_of(d, c) > 0;
    return side_of(c, d) < 0;
  }
  /// Positive where border d, which starts no lower than c, is left of c.
  static double side_of(const Crossing& c, const Crossing& d) {
    const double side = orient(*c.low, *c.high, *d.low);
    return side != 0 ? side : orient(*c.low, *c.high, *d.high);
  }

  /// The pixels of a row that lie in the box: [first, second).
  std::pair<int, int> in_box(int row) const {
    const Vector2d start = out_.point(0, row);
    const Vector3d p = section_.image_to_reference * Vector3d(start.x(), start.y(), 0);
    const Vector3d step = out_.spacing_mm * section_.image_to_reference.linear().col(0);
    double from = 1, to = out_.width - 2;
    for (int axis = 0; axis < 3; ++axis) {
      double low = (box_.min()[axis] - p[axis]) / step[axis], high = (box_.max()[axis] - p[axis]) / step[axis];
      if (std::abs(step[axis]) < 1e-12 * out_.spacing_mm) {
        const bool inside = box_.min()[axis] <= p[axis] && p[axis] <= box_.max()[axis];
        low = inside ? from : to + 1;
        high = to;
      } else if (step[axis] < 0) {
        std::swap(low, high);
      }
      from = std::max(from, std::ceil(low));
      to = std::min(to, std::floor(high));
    }
    return from <= to ? std::pair(static_cast<int>(from), static_cast<int>(to) + 1) : std::pair(0, 0);
  }

  void fill_row(int row) {
    const auto begin = crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[static_cast<std::size_t>(row)]);
    const auto end = crossings_.begin() + static_cast<std::ptrdiff_t>(begin_[static_cast<std::size_t>(row) + 1]);
    std::sort(begin, end, [&](const Crossing& c, const Crossing& d) { return is_left(c, d); });
    const auto [first, last] = in_box(row);
    const auto pixels = out_.label.begin() + static_cast<std::ptrdiff_t>(row) * out_.width;
    int at = first;
    Label label = section_.border;
    for (auto c = begin; c != end; ++c) {
      // The first pixel whose middle is not left of the crossing.
      const double pixel = std::ceil(c->x / out_.spacing_mm - out_.first.x() - 0.5);
      const int to = static_cast<int>(std::clamp(pixel, static_cast<double>(at), static_cast<double>(last)));
      std::fill(pixels + at, pixels + to, label);
      at = to;
      label = c->beyond;
    }
    std::fill(pixels + at, pixels + last, label);
  }

  const Section& section_;
  const Eigen::AlignedBox3d& box_;
  double unsure_mm_ = 0;  ///< crossings nearer than that may come out in the wrong order
  SectionRaster out_;
  std::vector<std::size_t> begin_;  ///< [height + 1] in crossings_
  std::vector<Crossing> crossings_;
};

}  // namespace

SectionRaster rasterize(const Section& section, double spacing_mm, const Eigen::AlignedBox3d& box) {
  assert(spacing_mm > 0 && !box.isEmpty());
  return Rasterizer(section, spacing_mm, box).run();
}

}  // namespace sonoloft
