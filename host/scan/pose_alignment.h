#pragma once
#include <Eigen/Geometry>
#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <vector>

#include "core/tracking/pose_track.h"
#include "host/device/delivered_slice.h"

// device -> slices -> [POSE ALIGNMENT] -> slices with the pose of their image's time -> reconstruction

namespace sonoloft {

/// Gives every slice the pose that the probe had when its image was taken, between those that the tracker measured: the
/// pose at the image's time + offset. A slice waits until a later pose is there, so slices come out up to one tracker
/// period and the offset late, in order. Where the tracker had no pose on either side the slice says `missing`.
/// Threads: one at a time.
class PoseAlignment {
 public:
  using Slice = std::shared_ptr<const device::DeliveredSlice>;

  /// `image_to_probe`: what the device's calibration put between pose and image
  PoseAlignment(std::chrono::nanoseconds offset, const Eigen::Isometry3d& image_to_probe)
      : offset_(offset), image_to_probe_(image_to_probe) {}

  /// Takes the next slice with the pose that came with it. @return the slices whose pose is known now
  [[nodiscard]] std::vector<Slice> push(Slice slice);
  /// What still waits, for no more poses come.
  [[nodiscard]] std::vector<Slice> flush();
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

 private:
  [[nodiscard]] Slice aligned(const device::DeliveredSlice& slice) const;

  std::chrono::nanoseconds offset_;
  Eigen::Isometry3d image_to_probe_;
  PoseTrack track_;
  std::deque<Slice> waiting_;
};

}  // namespace sonoloft
