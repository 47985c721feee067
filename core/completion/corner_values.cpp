#include "core/completion/corner_values.h"

#include <algorithm>
#include <cmath>

namespace sonoloft {
namespace {

constexpr double kPlaneWeight = 2;  ///< lambda

bool is_known(Label label) {
  return label != kUnknown && label != kBeyondFace;
}

/// The integral of |d phi| / r along a -> b around the origin: no angle is needed.
double rim_integral(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double cross = std::abs(a.x() * b.y() - a.y() * b.x()), ra = a.norm(), rb = b.norm();
  return cross > 0 ? cross * (ra + rb) / (ra * rb * (ra * rb + a.dot(b))) : 0;
}

}  // namespace

GroupKnowledge::GroupKnowledge(const std::vector<std::vector<SeenWall>>& walls, std::span<const CellId> group,
                               std::span<const Label> labels, double min_height_mm) {
  for (const CellId cell : group)
    for (const SeenWall& wall : walls[static_cast<std::uint32_t>(cell)])
      add(wall, std::binary_search(group.begin(), group.end(), wall.behind), labels, min_height_mm);
  for (KnownPlane& plane : planes_) plane.regions.finish();
}

void GroupKnowledge::add(const SeenWall& wall, bool twice_seen, std::span<const Label> labels, double min_height_mm) {
  const CellFace& face = wall.face;
  if (twice_seen && !face.above) return;
  auto plane = std::lower_bound(planes_.begin(), planes_.end(), face.plane,
                                [](const KnownPlane& p, PlaneId id) { return p.plane < id; });
  if (plane == planes_.end() || plane->plane != face.plane)
    plane = planes_.insert(plane, {face.plane,
                                   PlaneRegions(*face.image_to_reference, min_height_mm),
                                   face.image_to_reference->inverse(Eigen::Isometry),
                                   {}});
  const auto slot = [&](Label label) {
    return static_cast<std::uint32_t>(std::lower_bound(labels.begin(), labels.end(), label) - labels.begin());
  };
  for (const FaceEdge& e : *face.polygon) {
    if (is_known(e.left)) plane->regions.add(e.a, e.b, slot(e.left), {1, Eigen::Vector2d::Zero()});
    if (is_known(e.right)) plane->regions.add(e.b, e.a, slot(e.right), {1, Eigen::Vector2d::Zero()});
    if (e.left == kUnknown && is_known(e.right)) plane->rims.push_back({e.a, e.b, slot(e.right)});
    if (e.right == kUnknown && is_known(e.left)) plane->rims.push_back({e.a, e.b, slot(e.left)});
  }
}

void GroupKnowledge::shares(PlaneId plane, std::span<const Eigen::Vector3d> corners_mm,
                            std::span<PointLanes> shares) const {
  const PointBlock block(corners_mm, 0);
  for (PointLanes& lanes : shares) lanes.fill(0);
  for (const KnownPlane& known : planes_) {
    if (known.plane != plane) {
      known.regions.weigh(block, shares);
      continue;
    }
    for (std::size_t i = 0; i < kPointLanes; ++i) {
      const Eigen::Vector3d corner(block.x[i], block.y[i], block.z[i]);
      const Eigen::Vector2d foot = (known.reference_to_image * corner).head<2>();
      for (const Rim& rim : known.rims) shares[rim.slot][i] += kPlaneWeight * rim_integral(rim.a - foot, rim.b - foot);
    }
  }
  normalise(shares);
}

}  // namespace sonoloft
