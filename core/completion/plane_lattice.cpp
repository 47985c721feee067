#include "core/completion/plane_lattice.h"

#include <algorithm>
#include <cmath>

namespace sonoloft {
namespace {

constexpr double kGrowth = 1.5;

/// Lowest and highest coordinate on one axis.
std::pair<double, double> range(const FacePolygon& polygon, int axis) {
  std::pair<double, double> r{polygon.front().a[axis], polygon.front().a[axis]};
  for (const FaceEdge& e : polygon) {
    r.first = std::min({r.first, e.a[axis], e.b[axis]});
    r.second = std::max({r.second, e.a[axis], e.b[axis]});
  }
  return r;
}

/// Hands the parts of a polygon between lines of one axis to visit(i, part), i the line below; without what is known
/// throughout.
template <class Visit>
void for_each_strip(FacePolygon polygon, const std::vector<double>& lines, int axis, const Visit& visit) {
  const auto [low, high] = range(polygon, axis);
  const auto above_low = std::upper_bound(lines.begin() + 1, lines.end() - 1, low);
  for (auto i = static_cast<std::size_t>(above_low - lines.begin()) - 1; has_unknown(polygon); ++i) {
    if (i + 2 == lines.size() || lines[i + 1] >= high) {
      visit(i, std::move(polygon));
      return;
    }
    auto [below, above] = split(polygon, {Eigen::Vector2d::Unit(axis), -lines[i + 1]});
    if (has_unknown(below)) visit(i, std::move(below));
    polygon = std::move(above);
  }
}

void add_piece(const FacePolygon& polygon, const std::array<std::uint32_t, 3>& nodes, std::vector<UnknownPiece>& out) {
  UnknownPiece piece{nodes, {}};
  for (const FaceEdge& e : polygon) {
    if (e.left == kUnknown) piece.border.emplace_back(e.a, e.b);
    if (e.right == kUnknown) piece.border.emplace_back(e.b, e.a);
  }
  if (!piece.border.empty()) out.push_back(std::move(piece));
}

}  // namespace

std::vector<double> graded_lines(double low, double high, double from, double to, double spacing_mm) {
  const int count = std::max(1, static_cast<int>(std::ceil((high - low) / spacing_mm)));
  const double step_mm = high > low ? (high - low) / count : spacing_mm;
  std::vector<double> lines;
  double gap = kGrowth * step_mm;
  for (double at = low; at > from; gap *= kGrowth) lines.push_back(at -= gap);
  std::reverse(lines.begin(), lines.end());
  for (int i = 0; i <= count; ++i) lines.push_back(low + step_mm * i);
  gap = kGrowth * step_mm;
  for (double at = lines.back(); at < to; gap *= kGrowth) lines.push_back(at += gap);
  return lines;
}

std::vector<UnknownPiece> unknown_pieces(const PlaneLattice& lattice, const FacePolygon& polygon) {
  std::vector<UnknownPiece> pieces;
  if (polygon.empty()) return pieces;
  for_each_strip(polygon, lattice.x, 0, [&](std::size_t i, FacePolygon column) {
    for_each_strip(std::move(column), lattice.y, 1, [&](std::size_t j, const FacePolygon& part) {
      const Eigen::Vector2d low(lattice.x[i], lattice.y[j]);
      const Eigen::Vector2d diagonal = (Eigen::Vector2d(lattice.x[i + 1], lattice.y[j + 1]) - low).normalized();
      const Eigen::Vector2d left(-diagonal.y(), diagonal.x());
      const auto [below, above] = split(part, {left, -left.dot(low)});
      const std::uint32_t first = lattice.node(i, j), last = lattice.node(i + 1, j + 1);
      add_piece(below, {first, lattice.node(i + 1, j), last}, pieces);
      add_piece(above, {first, last, lattice.node(i, j + 1)}, pieces);
    });
  });
  return pieces;
}

}  // namespace sonoloft
