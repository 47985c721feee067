#include "device_sim/probe/phantoms/solid_phantom.h"

#include <algorithm>
#include <cmath>

#include "device_sim/probe/phantoms/section_tracer.h"

namespace sonoloft::device_sim {
namespace {

Eigen::Isometry3d at(const Eigen::Vector3d& centre_mm) {
  return Eigen::Isometry3d(Eigen::Translation3d(centre_mm));
}

bool holds(const Solid& solid, const Eigen::Vector3d& point_mm) {
  const Eigen::Vector3d p = solid.reference_to_solid * point_mm;
  const Eigen::Vector3d& s = solid.size_mm;
  switch (solid.shape) {
    case Solid::Shape::ellipsoid:
      return p.cwiseQuotient(s).squaredNorm() <= 1;
    case Solid::Shape::box:
      return (p.cwiseAbs().array() <= s.array()).all();
    case Solid::Shape::capsule: {
      const double z = p.z() - std::clamp(p.z(), -s.y(), s.y());
      return p.x() * p.x() + p.y() * p.y() + z * z <= s.x() * s.x();
    }
    case Solid::Shape::torus: {
      const double from_ring = std::hypot(p.x(), p.y()) - s.x();
      return from_ring * from_ring + p.z() * p.z() <= s.y() * s.y();
    }
  }
  return false;
}

Eigen::Vector3d half_extent(const Solid& solid) {
  const Eigen::Vector3d& s = solid.size_mm;
  switch (solid.shape) {
    case Solid::Shape::capsule:
      return {s.x(), s.x(), s.y() + s.x()};
    case Solid::Shape::torus:
      return {s.x() + s.y(), s.x() + s.y(), s.y()};
    default:
      return s;
  }
}

Eigen::AlignedBox3d box_around(const Solid& solid) {
  const Eigen::Isometry3d pose = solid.reference_to_solid.inverse();
  const Eigen::Vector3d half = pose.linear().cwiseAbs() * half_extent(solid);
  return {pose.translation() - half, pose.translation() + half};
}

}  // namespace

Solid sphere(const Eigen::Vector3d& centre_mm, double radius_mm, Label label) {
  return ellipsoid(at(centre_mm), Eigen::Vector3d::Constant(radius_mm), label);
}

Solid ellipsoid(const Eigen::Isometry3d& solid_to_reference, const Eigen::Vector3d& half_axes_mm, Label label) {
  return {Solid::Shape::ellipsoid, solid_to_reference.inverse(), half_axes_mm, label};
}

Solid box(const Eigen::Isometry3d& solid_to_reference, const Eigen::Vector3d& half_edges_mm, Label label) {
  return {Solid::Shape::box, solid_to_reference.inverse(), half_edges_mm, label};
}

Solid capsule(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& to_mm, double radius_mm, Label label) {
  const Eigen::Vector3d along = to_mm - from_mm;
  const Eigen::Isometry3d pose =
      at((from_mm + to_mm) / 2) * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), along);
  return {Solid::Shape::capsule, pose.inverse(), {radius_mm, along.norm() / 2, 0}, label};
}

Solid torus(const Eigen::Isometry3d& solid_to_reference, double ring_radius_mm, double tube_radius_mm, Label label) {
  return {Solid::Shape::torus, solid_to_reference.inverse(), {ring_radius_mm, tube_radius_mm, 0}, label};
}

SolidPhantom::SolidPhantom(std::vector<Solid> solids) : solids_(std::move(solids)) {
  constexpr double kLinesOnDiagonal = 400;
  for (const Solid& solid : solids_) {
    boxes_.push_back(box_around(solid));
    if (solid.label != kOutside) bounds_.extend(boxes_.back());
  }
  spacing_mm_ = bounds_.diagonal().norm() / kLinesOnDiagonal;
}

Label SolidPhantom::label_at(const Eigen::Vector3d& point_mm) const {
  for (std::size_t i = solids_.size(); i-- > 0;)
    if (boxes_[i].contains(point_mm) && holds(solids_[i], point_mm)) return solids_[i].label;
  return kOutside;
}

PhantomSection SolidPhantom::section(const Eigen::Isometry3d& plane_to_reference) const {
  return trace_section(section_area(bounds_, plane_to_reference), plane_to_reference, spacing_mm_,
                       [this](const Eigen::Vector3d& point_mm) { return label_at(point_mm); });
}

PhantomSection SolidPhantom::section_in(const Eigen::AlignedBox2d& window,
                                        const Eigen::Isometry3d& plane_to_reference) const {
  return trace_section(section_area(bounds_, plane_to_reference).intersection(window), plane_to_reference, spacing_mm_,
                       [this](const Eigen::Vector3d& point_mm) { return label_at(point_mm); });
}

SolidPhantom organs_phantom() {
  const auto label = [](Organ organ) { return static_cast<Label>(organ); };
  const auto turned = [](const Eigen::Vector3d& centre_mm, double angle_rad, const Eigen::Vector3d& axis) {
    return at(centre_mm) * Eigen::AngleAxisd(angle_rad, axis.normalized());
  };
  return SolidPhantom({
      ellipsoid(at({0, 0, 0}), {80, 55, 100}, label(Organ::body)),
      ellipsoid(turned({-25, 5, 25}, 0.5, {1, 2, 3}), {42, 30, 38}, label(Organ::liver)),
      ellipsoid(turned({-22, 8, -30}, -0.4, {0, 1, 1}), {20, 18, 32}, label(Organ::kidney)),
      sphere({-32, 6, 30}, 13, label(Organ::tumour)),
      torus(turned({38, 0, 10}, 1.1, {1, 0, 0.3}), 20, 7, kOutside),
      capsule({-55, -10, 8}, {0, 28, 60.6}, 4.5, label(Organ::vessel)),
  });
}

}  // namespace sonoloft::device_sim
