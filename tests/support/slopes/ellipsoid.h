#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "core/slice/section.h"

namespace sonoloft::test {

/// An ellipsoid around the origin, its axes those of the frame.
struct Ellipsoid {
  Eigen::Vector3d radii;
  Label label = 1;

  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& at) const {
    return at.cwiseQuotient(radii.cwiseAbs2()).normalized();
  }

  /// A polygon of n exact points, counter-clockwise; none where the plane misses it, nearly.
  [[nodiscard]] Section cut(const Eigen::Isometry3d& frame, std::uint32_t n) const {
    Section section;
    section.image_to_reference = frame;
    const Eigen::Matrix3d form = radii.cwiseAbs2().cwiseInverse().asDiagonal();
    const Eigen::Matrix<double, 3, 2> plane = frame.linear().leftCols<2>();
    const Eigen::Matrix2d conic = plane.transpose() * form * plane;
    const Eigen::Vector2d slant = plane.transpose() * form * frame.translation();
    const Eigen::Vector2d centre = -conic.inverse() * slant;
    const double size = 1 - frame.translation().dot(form * frame.translation()) - centre.dot(slant);
    if (size < 1e-3) return section;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
      section.points.push_back(centre + direction * std::sqrt(size / direction.dot(conic * direction)));
      section.edges.push_back({i, (i + 1) % n, label, kOutside});
    }
    return section;
  }
};

/// How a surface with this normal leaves a slice: how far it goes outward per height.
inline double slope_of(const Eigen::Vector3d& surface_normal, const Eigen::Vector3d& slice_normal) {
  const double rise = surface_normal.dot(slice_normal);
  return -rise / (surface_normal - rise * slice_normal).norm();
}

}  // namespace sonoloft::test
