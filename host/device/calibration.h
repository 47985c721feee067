#pragma once
#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>

#include "core/slice/result.h"
#include "host/device/delivered_slice.h"
#include "protocol/command.h"
#include "protocol/slice.h"

namespace sonoloft::device {

/// ImageToProbe taken apart: pixel sizes, which go into the points, and a rigid rest, which goes into the pose.
/// Frames: image (pixels, then mm) -> probe, mm, right-handed.
struct Calibration {
  std::uint32_t id = 0;
  Eigen::Vector2d pixel_size_mm = Eigen::Vector2d::Ones();
  Eigen::Isometry3d image_to_probe = Eigen::Isometry3d::Identity();
};

/// The first two columns of the matrix are the steps of one pixel in x and in y, the last is the image's origin. The
/// third says nothing about a plane: z of the image is x cross y, whichever way the matrix has it.
/// @error not_available (id 0: the device has none), non_finite, not_rigid (a step shorter than 1e-6 mm, or the axes
///        more than 0.06 degrees off a right angle; less is made square, keeping x)
[[nodiscard]] Result<Calibration> make_calibration(const protocol::CalibrationMessage& message);

/// An accepted slice in mm: points, or the borders of its mask, times pixel size, image_to_reference = ProbeToReference
/// * ImageToProbe.
/// @pre  slice passed protocol::check_slice(); slice.calibration_id == calibration.id
/// @cost O(#V + #C + #F), or that of trace_mask(); allocates
[[nodiscard]] DeliveredSlice to_delivered(const protocol::Slice& slice, std::uint64_t seq,
                                          const Calibration& calibration,
                                          std::chrono::steady_clock::time_point arrival);

}  // namespace sonoloft::device
