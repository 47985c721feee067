#include "device_sim/probe/phantoms/recorded_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace sonoloft::device_sim {
namespace {

std::string check(const RecordedPlane& plane) {
  const Eigen::Matrix3d& r = plane.plane_to_reference.linear();
  if (!plane.plane_to_reference.matrix().allFinite() || !(r * r.transpose()).isIdentity(1e-6) || r.determinant() < 0)
    return "has a pose that is not rigid";
  std::size_t next = 0;
  for (const SectionLoop& loop : plane.section.loops) {
    if (loop.first != next || loop.count < 3) return "has loops that do not follow one another with 3 points or more";
    next += loop.count;
  }
  if (next != plane.section.points.size()) return "has points without a loop or loops without points";
  for (const auto* points : {&plane.section.points, &plane.section.field_of_view})
    for (const Eigen::Vector2d& p : *points)
      if (!p.allFinite()) return "has a point that is not a finite number";
  return {};
}

Eigen::Vector3d in_reference(const RecordedPlane& plane, const Eigen::Vector2d& p) {
  return plane.plane_to_reference * Eigen::Vector3d(p.x(), p.y(), 0);
}

}  // namespace

Made<RecordedPlanes> RecordedPlanes::make(std::vector<RecordedPlane> planes) {
  std::unique_ptr<RecordedPlanes> recorded(new RecordedPlanes);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string error = check(planes[i]);
    if (!error.empty()) return {nullptr, "recording: plane " + std::to_string(i) + " " + error + "; leave it out"};
    for (const Eigen::Vector2d& p : planes[i].section.points) recorded->bounds_.extend(in_reference(planes[i], p));
  }
  if (recorded->bounds_.isEmpty()) return {nullptr, "recording: no plane has a contour; nothing could be scanned"};
  recorded->planes_ = std::move(planes);
  return {std::move(recorded), {}};
}

PhantomSection RecordedPlanes::section(const Eigen::Isometry3d& plane_to_reference) const {
  constexpr double kTolerance = 1e-6;
  const double extent = bounds_.diagonal().norm();
  // How far a plane's own origin and normal are from the asked plane.
  const auto distance = [&](const RecordedPlane& plane) {
    const Eigen::Isometry3d to_asked = plane_to_reference.inverse() * plane.plane_to_reference;
    return std::max(std::abs(to_asked.translation().z()) / extent, to_asked.linear().col(2).head<2>().norm());
  };
  const auto nearest =
      std::min_element(planes_.begin(), planes_.end(),
                       [&](const RecordedPlane& a, const RecordedPlane& b) { return distance(a) < distance(b); });
  if (distance(*nearest) > kTolerance) return {};
  PhantomSection section = nearest->section;
  const Eigen::Isometry3d to_asked = plane_to_reference.inverse() * nearest->plane_to_reference;
  for (auto* points : {&section.points, &section.field_of_view})
    for (Eigen::Vector2d& p : *points) p = (to_asked * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>();
  return section;
}

std::vector<Eigen::Isometry3d> RecordedPlanes::trajectory() const {
  std::vector<Eigen::Isometry3d> poses;
  for (const RecordedPlane& plane : planes_) poses.push_back(plane.plane_to_reference);
  return poses;
}

}  // namespace sonoloft::device_sim
