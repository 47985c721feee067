#include "core/mesh/vertices/contour_snap.h"

#include <algorithm>
#include <limits>

#include "core/mesh/vertices/brick_cells.h"
#include "core/octree/grid_walk.h"

namespace sonoloft {
namespace {

/// A corner of a contour that lies less than this far off the surface, in lattice steps, is not worth a narrow
/// triangle.
constexpr float kCutOff = 0.1F;

std::array<float, 3> numbers(const Eigen::Vector3f& p) {
  return {p.x(), p.y(), p.z()};
}

/// The point of the segment a b nearest to p.
Eigen::Vector3f nearest_on(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& p) {
  const Eigen::Vector3f ab = b - a;
  const float length2 = ab.squaredNorm();
  return length2 > 0.0F ? Eigen::Vector3f(a + std::clamp(ab.dot(p - a) / length2, 0.0F, 1.0F) * ab) : a;
}

}  // namespace

void spans_of(std::span<const ContourPiece> contours, std::span<const std::uint16_t> slot,
              std::span<const LabelPair> pairs, std::vector<ContourSpan>& spans) {
  for (const ContourPiece& piece : contours) {
    const Eigen::Vector3f step = piece.b - piece.a;
    walk_grid(piece.a.cast<double>(), piece.b.cast<double>(), [&](double from, double to) {
      const Eigen::Vector3f p = piece.a + static_cast<float>(from) * step, q = piece.a + static_cast<float>(to) * step;
      const Eigen::Vector3i at = (0.5F * (p + q)).array().floor().cast<int>().max(0).min(kBrickSize - 1);
      const std::uint16_t s = slot[static_cast<std::size_t>(sample_index(at.x(), at.y(), at.z()))];
      if (s >= BrickCells::kComplex || pairs[s] != LabelPair{piece.lower, piece.upper}) return;
      const Eigen::Vector3f base = at.cast<float>();
      const std::uint32_t ends = (from == 0.0 && piece.a_is_end ? 1u : 0u) | (to == 1.0 && piece.b_is_end ? 2u : 0u);
      spans.push_back({s, numbers(p - base), numbers(q - base), ends});
    });
  }
  std::ranges::stable_sort(spans, {}, &ContourSpan::slot);
}

CellPoint put_on_contour(std::span<const ContourSpan> spans, const CellPoint& vertex, const Gap& gap) {
  const Eigen::Vector3f at = to_steps(vertex), normal = normal_at(vertex, gap);
  float least = std::numeric_limits<float>::infinity(), cut_off = kCutOff;
  Eigen::Vector3f nearest = at, corner = at;
  for (const ContourSpan& span : spans) {
    const std::array<Eigen::Vector3f, 2> ends{Eigen::Vector3f(span.a.data()), Eigen::Vector3f(span.b.data())};
    const Eigen::Vector3f on = nearest_on(ends[0], ends[1], at);
    if (const float away = (on - at).squaredNorm(); away < least) {
      least = away;
      nearest = on;
    }
    for (unsigned k = 0; k < 2; ++k) {
      const float off = std::abs(normal.dot(ends[k] - at));
      if ((span.ends >> k & 1) == 0 || !(off > cut_off)) continue;
      cut_off = off;
      corner = ends[k];
    }
  }
  return to_cell_point(cut_off > kCutOff ? corner : nearest);
}

}  // namespace sonoloft
