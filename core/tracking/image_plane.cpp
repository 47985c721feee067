#include "core/tracking/image_plane.h"

namespace sonoloft {

std::optional<ImagePlane> image_plane(const Eigen::Affine3d& pixels_to_reference) {
  constexpr double kLeastSine = 0.1;
  const Eigen::Vector3d column = pixels_to_reference.linear().col(0), row = pixels_to_reference.linear().col(1);
  const Eigen::Vector3d across = column.cross(row);
  if (!(across.norm() > kLeastSine * column.norm() * row.norm()) || !across.allFinite()) return std::nullopt;
  ImagePlane plane;
  const Eigen::Vector3d x = column.normalized(), z = across.normalized(), y = z.cross(x);
  plane.image_to_reference.linear() << x, y, z;
  plane.image_to_reference.translation() = pixels_to_reference.translation();
  plane.mm_per_pixel << column.norm(), x.dot(row), 0, y.dot(row);
  return plane;
}

}  // namespace sonoloft
