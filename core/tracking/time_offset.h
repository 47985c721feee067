#pragma once
#include <Eigen/Core>
#include <chrono>
#include <optional>
#include <span>

#include "core/slice/result.h"
#include "core/tracking/pose_track.h"

namespace sonoloft {

/// Something seen in an image that moves with the probe along one direction.
struct TimedValue {
  std::chrono::nanoseconds time{0};  ///< the image's
  double value = 0;                  ///< any unit
};

struct TimeOffset {
  /// The pose that belongs to an image is that of the image's time + offset.
  std::chrono::nanoseconds offset{0};
  double correlation = 0;  ///< of what was seen and what the tracker measured, at this offset, 0..1
};

/// The offset between the times of images and of poses that makes a probe's motion look the same in both: what is seen
/// is correlated with the way that the probe went along its main direction, for every offset of up to half a second
/// (PLUS, temporal calibration). The motion must be along one line, back and forth, and seen in the images.
/// @error empty_input (fewer than 20 images with poses around them), invalid_argument (the probe rested, or nothing
///        correlates above 0.9: another motion, another object)
/// @cost  O(images) for each of 1000 offsets
[[nodiscard]] Result<TimeOffset> estimate_time_offset(std::span<const TimedValue> seen, const PoseTrack& track);

}  // namespace sonoloft
