#include "core/slopes/crossings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/slopes/windows.h"

namespace sonoloft {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastPlaneAngle = 0.1;    ///< sine
constexpr double kLeastTangentAngle = 0.2;  ///< sine: flatter, and their cross product is noise
constexpr double kLeastUpright = 0.05;      ///< sine of surface and plane

/// Where a contour meets the common line of two planes.
struct Hit {
  Label left, right;
  bool leaves;  ///< going along the line: from left to right
  double at_mm;
  std::uint32_t arc;
  double along_mm;
  Vector3d outward, tangent;

  [[nodiscard]] auto kind() const { return std::tie(left, right, leaves); }
};

std::vector<Hit> hits_on(const SliceContours& own, const SliceContours& other, const Vector3d& line) {
  const auto rotation = own.image_to_reference.linear();
  const Vector3d other_normal = other.normal();
  Vector2d normal = (rotation.transpose() * other_normal).head<2>();
  const double length = normal.norm();
  const double offset =
      other_normal.dot(own.image_to_reference.translation() - other.image_to_reference.translation()) / length;
  normal /= length;
  std::vector<Hit> hits;
  own.borders.visit_near_line(normal, offset, [&](std::uint32_t place) {
    const Arc& arc = own.arcs.arc_at(place);
    const std::uint32_t next = arc.next(place);
    const Vector2d &a = own.calm.points[own.arcs.point[place]], &b = own.calm.points[own.arcs.point[next]];
    const double da = normal.dot(a) + offset, db = normal.dot(b) + offset;
    if (!arc.is_surface() || (da < 0) == (db < 0) || !own.is_on_wall(place)) return;
    const double share = da / (da - db);
    const Vector2d point = a + share * (b - a);
    const Vector2d nu =
        ((1 - share) * own.shape.outward[place].cast<double>() + share * own.shape.outward[next].cast<double>())
            .stableNormalized();
    const Vector2d edge_outward((b - a).y(), -(b - a).x());
    hits.push_back({arc.left, arc.right, line.dot(rotation.leftCols<2>() * edge_outward) > 0,
                    line.dot(own.image_to_reference * Vector3d(point.x(), point.y(), 0)), own.arcs.arc[place],
                    own.arcs.along_mm[place] + share * (b - a).norm(), rotation.leftCols<2>() * nu,
                    rotation.leftCols<2>() * Vector2d(-nu.y(), nu.x())});
  });
  std::sort(hits.begin(), hits.end(), [](const Hit& l, const Hit& r) {
    return std::tuple(l.kind(), l.at_mm, l.arc, l.along_mm) < std::tuple(r.kind(), r.at_mm, r.arc, r.along_mm);
  });
  return hits;
}

/// The nearest of the same kind; hits are sorted by kind, then along the line.
const Hit* nearest(const std::vector<Hit>& hits, const Hit& to) {
  const auto after = std::lower_bound(hits.begin(), hits.end(), to, [](const Hit& l, const Hit& r) {
    return std::tuple(l.kind(), l.at_mm) < std::tuple(r.kind(), r.at_mm);
  });
  const Hit* best = nullptr;
  const auto consider = [&](const Hit& hit) {
    if (hit.kind() != to.kind()) return;
    if (best == nullptr || std::abs(hit.at_mm - to.at_mm) < std::abs(best->at_mm - to.at_mm)) best = &hit;
  };
  if (after != hits.begin()) consider(*(after - 1));
  if (after != hits.end()) consider(*after);
  return best;
}

/// The slopes of a surface that both contours lie on.
std::optional<std::pair<double, double>> slopes(const Hit& a, const Vector3d& normal_a, const Hit& b,
                                                const Vector3d& normal_b) {
  Vector3d n = a.tangent.cross(b.tangent);
  if (n.norm() < kLeastTangentAngle) return std::nullopt;
  n.normalize();
  if (n.dot(a.outward) < 0) n = -n;
  const double upright_a = n.dot(a.outward), upright_b = n.dot(b.outward);
  if (upright_a < kLeastUpright || upright_b < kLeastUpright) return std::nullopt;
  return std::pair(-n.dot(normal_a) / upright_a, -n.dot(normal_b) / upright_b);
}

Crossing crossing(const Hit& hit, double slope, SliceId other) {
  return {hit.arc, static_cast<float>(hit.along_mm), static_cast<float>(std::atan(slope)), other};
}

}  // namespace

std::pair<std::vector<Crossing>, std::vector<Crossing>> crossings_of(SliceId a, const SliceContours& contours_a,
                                                                     SliceId b, const SliceContours& contours_b,
                                                                     double feature_mm) {
  std::pair<std::vector<Crossing>, std::vector<Crossing>> found;
  const Vector3d normal_a = contours_a.normal(), normal_b = contours_b.normal();
  const Vector3d line = normal_a.cross(normal_b);
  if (line.norm() < kLeastPlaneAngle) return found;
  const std::vector<Hit> on_a = hits_on(contours_a, contours_b, line.normalized());
  if (on_a.empty()) return found;
  const std::vector<Hit> on_b = hits_on(contours_b, contours_a, line.normalized());
  for (const Hit& hit : on_a) {
    const Hit* const partner = nearest(on_b, hit);
    if (partner == nullptr || nearest(on_a, *partner) != &hit) continue;
    if (std::abs(partner->at_mm - hit.at_mm) > kCrossingTolerance * feature_mm) continue;
    const auto both = slopes(hit, normal_a, *partner, normal_b);
    if (!both) continue;
    found.first.push_back(crossing(hit, both->first, b));
    found.second.push_back(crossing(*partner, both->second, a));
  }
  return found;
}

}  // namespace sonoloft
