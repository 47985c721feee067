#include "core/field/packing/bent_face.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sonoloft {
namespace {

/// Sine of the angle up to which two pieces of an outline are one side of the face.
constexpr double kStraight = 1e-6;

/// A bend between two: linear. Turned round where the two look at the contour from different sides.
VertexBend between(const VertexBend& a, VertexBend b, float t) {
  if (a.outward.dot(b.outward) < 0) b = {-b.outward, -b.slope, -b.curvature_per_mm, b.fading_per_mm};
  return {a.outward + t * (b.outward - a.outward), a.slope + t * (b.slope - a.slope),
          a.curvature_per_mm + t * (b.curvature_per_mm - a.curvature_per_mm),
          a.fading_per_mm + t * (b.fading_per_mm - a.fading_per_mm)};
}

VertexBend bend_at(const Eigen::Vector2d& point, const SectionEdge& edge, const FaceBends& bends) {
  const Eigen::Vector2d& start = bends.section->points[edge.a];
  const Eigen::Vector2d& end = bends.section->points[edge.b];
  if (point == start) return bends.bends[edge.a];
  if (point == end) return bends.bends[edge.b];
  const double t = (point - start).dot(end - start) / (end - start).squaredNorm();
  return between(bends.bends[edge.a], bends.bends[edge.b], static_cast<float>(std::clamp(t, 0.0, 1.0)));
}

std::tuple<double, double> key(const Eigen::Vector2d& p) {
  return {p.x(), p.y()};
}

}  // namespace

std::span<const EdgeBends> BentFace::bend(const FacePolygon& polygon, const FaceBends& bends) {
  edges_.assign(polygon.size(), {});
  collect_outline(polygon);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const FaceEdge& e = polygon[i];
    if (e.source == kNoSource) continue;
    const SectionEdge& source = bends.section->edges[e.source];
    edges_[i] = {bend_at(e.a, source, bends), bend_at(e.b, source, bends)};
    bend_end(e.a, edges_[i].a);
    bend_end(e.b, edges_[i].b);
  }
  for (std::size_t i = 0; i < polygon.size(); ++i)
    if (polygon[i].source == kNoSource)
      edges_[i] = {outline_at(polygon[i].a).front().bend, outline_at(polygon[i].b).front().bend};
  return edges_;
}

void BentFace::collect_outline(const FacePolygon& polygon) {
  outline_.clear();
  for (const FaceEdge& e : polygon) {
    if (e.source != kNoSource) continue;
    const Eigen::Vector2d along = (e.b - e.a).normalized();
    outline_.push_back({e.a, along, {}});
    outline_.push_back({e.b, along, {}});
  }
  std::sort(outline_.begin(), outline_.end(),
            [](const OutlineEnd& l, const OutlineEnd& r) { return key(l.point) < key(r.point); });
}

std::span<BentFace::OutlineEnd> BentFace::outline_at(const Eigen::Vector2d& point) {
  const auto [first, last] =
      std::equal_range(outline_.begin(), outline_.end(), OutlineEnd{point, {}, {}},
                       [](const OutlineEnd& l, const OutlineEnd& r) { return key(l.point) < key(r.point); });
  return {first, last};
}

/// Where a border ends on a side of the face it moves along that side, and so do the pieces of the side.
void BentFace::bend_end(const Eigen::Vector2d& point, VertexBend& bend) {
  const std::span<OutlineEnd> ends = outline_at(point);
  if (ends.empty()) return;
  const Eigen::Vector2f along = ends.front().along.cast<float>();
  const bool corner = std::any_of(ends.begin(), ends.end(), [&](const OutlineEnd& end) {
    const Eigen::Vector2d& l = ends.front().along;
    return std::abs(l.x() * end.along.y() - l.y() * end.along.x()) > kStraight;
  });
  bend = corner ? VertexBend{}
                : VertexBend{bend.outward.dot(along) * along, bend.slope, bend.curvature_per_mm, bend.fading_per_mm};
  ends.front().bend = bend;
}

}  // namespace sonoloft
