#include "core/field/reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace sonoloft {
namespace {

/// 2 h times what the region left of a -> b weighs: D * theta / |(a - x) x (b - x)|.
double edge_sum(const FaceEdge& edge, const Eigen::Vector2d& foot, double height) {
  const Eigen::Vector2d a = edge.a - foot, e = edge.b - edge.a;
  const double cross = a.x() * e.y() - a.y() * e.x();
  const double w = std::sqrt(cross * cross + e.squaredNorm() * height * height);
  return w > 0 ? cross * std::atan2(w, a.squaredNorm() + height * height + a.dot(e)) / w : 0;
}

}  // namespace

double ReferenceShares::share(Label label) const {
  const auto at = std::find_if(shares.begin(), shares.end(), [&](const Entry& e) { return e.label == label; });
  return at == shares.end() ? 0 : at->share;
}

ReferenceShares reference_shares(std::span<const CellFace> faces, const Eigen::Vector3d& point_mm,
                                 double min_height_mm) {
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
  for (const CellFace& face : faces) {
    const Eigen::Vector3d p = face.image_to_reference->inverse() * point_mm;
    const double height = std::max(face.above ? p.z() : -p.z(), min_height_mm);
    for (const FaceEdge& edge : *face.polygon) {
      const double weight = edge_sum(edge, p.head<2>(), height) / (2 * height);
      add(edge.left, weight);
      add(edge.right, -weight);
    }
  }
  for (const auto& entry : result.shares) result.total_per_mm += entry.share;
  assert(result.total_per_mm > 0);
  for (auto& entry : result.shares) entry.share /= result.total_per_mm;
  return result;
}

}  // namespace sonoloft
