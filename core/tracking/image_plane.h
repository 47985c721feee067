#pragma once
#include <Eigen/Geometry>
#include <optional>

namespace sonoloft {

/// Where an image lies, and what its pixels are in mm. The image frame has its origin in the middle of pixel (0, 0), x
/// along the rows and y, as far as the image has it so, along the columns.
struct ImagePlane {
  Eigen::Isometry3d image_to_reference = Eigen::Isometry3d::Identity();
  Eigen::Matrix2d mm_per_pixel = Eigen::Matrix2d::Identity();  ///< pixels (column, row) -> mm
};

/// Takes a calibrated transform apart, whose pixels need be neither square nor quite at right angles.
/// @param pixels_to_reference  (column, row, 0) -> mm
/// @return nothing where rows and columns run along each other or are no length
[[nodiscard]] std::optional<ImagePlane> image_plane(const Eigen::Affine3d& pixels_to_reference);

}  // namespace sonoloft
