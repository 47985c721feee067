#include "core/field/reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace sonoloft {
namespace {

/// 2 h times what the region left of a -> b weighs: D * theta / |(a - x) x (b - x)|.
double edge_sum(const Eigen::Vector2d& start, const Eigen::Vector2d& end, const Eigen::Vector2d& foot, double height) {
  const Eigen::Vector2d a = start - foot, e = end - start;
  const double cross = a.x() * e.y() - a.y() * e.x();
  const double w = std::sqrt(cross * cross + e.squaredNorm() * height * height);
  return w > 0 ? cross * std::atan2(w, a.squaredNorm() + height * height + a.dot(e)) / w : 0;
}

/// How far a point of a contour moves. @param reach_mm  height * sqrt(share of the face), on the side of the slope
Eigen::Vector2d displacement(const VertexBend& bend, double height_mm, double reach_mm) {
  const double c = bend.curvature_per_mm, u = bend.fading_per_mm * height_mm;
  double a = bend.slope * reach_mm;
  if (c * a < 0) a /= 1 - c * a;  // no two points of a circle meet
  return (2 * a + c * height_mm * height_mm) / (2 + u * u * u * u) * bend.outward.cast<double>();
}

}  // namespace

double ReferenceShares::share(Label label) const {
  const auto at = std::find_if(shares.begin(), shares.end(), [&](const Entry& e) { return e.label == label; });
  return at == shares.end() ? 0 : at->share;
}

ReferenceShares reference_shares(std::span<const CellFace> faces, const Eigen::Vector3d& point_mm, double min_height_mm,
                                 std::span<const FaceBends> bends) {
  ReferenceShares result;
  const auto add = [&](Label label, double weight) {
    if (label == kBeyondFace) return;
    const auto at = std::lower_bound(result.shares.begin(), result.shares.end(), label,
                                     [](const ReferenceShares::Entry& e, Label l) { return e.label < l; });
    if (at != result.shares.end() && at->label == label)
      at->share += weight;
    else
      result.shares.insert(at, {label, weight});
  };
  std::vector<double> whole;
  for (const CellFace& face : faces) {
    const Eigen::Vector3d p = face.image_to_reference->inverse() * point_mm;
    const double height = std::max(face.above ? p.z() : -p.z(), min_height_mm);
    double sum = 0;
    for (const FaceEdge& edge : *face.polygon)
      if (edge.right == kBeyondFace) sum += edge_sum(edge.a, edge.b, p.head<2>(), height) / (2 * height);
    whole.push_back(sum);
    result.total_per_mm += sum;
  }
  BentFace bent;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const CellFace& face = faces[f];
    const Eigen::Vector3d p = face.image_to_reference->inverse() * point_mm;
    const double height = std::max(face.above ? p.z() : -p.z(), min_height_mm);
    const double reach = (face.above ? 1 : -1) * height * std::sqrt(std::max(0.0, whole[f] / result.total_per_mm));
    const bool moves = !bends.empty() && !bends[f].bends.empty();
    const std::span<const EdgeBends> edge_bends =
        moves ? bent.bend(*face.polygon, bends[f]) : std::span<const EdgeBends>();
    for (std::size_t i = 0; i < face.polygon->size(); ++i) {
      const FaceEdge& edge = (*face.polygon)[i];
      Eigen::Vector2d a = edge.a, b = edge.b;
      if (moves) {
        a += displacement(edge_bends[i].a, height, reach);
        b += displacement(edge_bends[i].b, height, reach);
      }
      const double weight = edge_sum(a, b, p.head<2>(), height) / (2 * height);
      add(edge.left, weight);
      add(edge.right, -weight);
    }
  }
  assert(result.total_per_mm > 0);
  for (auto& entry : result.shares) entry.share /= result.total_per_mm;
  return result;
}

}  // namespace sonoloft
