#pragma once
#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <vector>

#include "core/slice/label.h"

namespace sonoloft {

/// One closed loop of a slice: the points [first, first + count), the last joined to the first.
struct Contour {
  std::uint32_t first;
  std::uint32_t count;  ///< at least 3
  Label label;          ///< what it encloses; kUnknown marks a shadow; of a hole it is not used
  bool hole;            ///< encloses outside
};

/// A segmented ultrasound image and where it was taken: what comes out of a device or a file and goes into the
/// reconstruction. The label of a point is the label of the smallest contour (by area) that encloses it (even-odd; of
/// two equal ones the one that is no hole), outside where none does, unknown where it is outside of the field of view.
/// Orientation of a contour means nothing. Contours may touch, share stretches, nest and (repaired) cross.
/// Frame: image = the slice's plane in mm, x and y in the image, z along the normal (right-handed); reference in mm.
struct TrackedSlice {
  std::uint64_t id = 0;              ///< the sender's sequence number or the file's index
  std::chrono::nanoseconds time{0};  ///< device clock, middle of the acquisition
  Eigen::Isometry3d image_to_reference = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> points;         ///< [#V] mm, image frame
  std::vector<Contour> contours;               ///< [#C]
  std::vector<Eigen::Vector2d> field_of_view;  ///< [#F] closed polygon, mm, image; empty: the whole plane was seen
};

}  // namespace sonoloft
