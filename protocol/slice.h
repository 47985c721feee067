#pragma once
#include <cstdint>
#include <span>

namespace sonoloft::protocol {

/// A label of a contour: 1..max_label are materials; 0 is outside (holes only); 0xFFFF is "not measured" (shadow).
using WireLabel = std::uint16_t;
inline constexpr WireLabel kUnknownLabel = 0xFFFF;

/// A point of the image. Frame: image, pixels, x to the right, y down the image as the calibration says.
struct Point {
  float x_px, y_px;
};

/// One closed loop: the points [first, first + count), the last joined to the first.
struct Contour {
  std::uint32_t first;
  std::uint32_t count;  ///< at least 3
  WireLabel label;      ///< of a hole it is not used
  std::uint16_t flags;  ///< kHoleFlag or 0
};
inline constexpr std::uint16_t kHoleFlag = 1;  ///< the contour encloses outside

/// The pixels of a label mask: squares of step x step, the first one around (x, y), `width` to the right, `height` rows
/// down. Frame: image, pixels of the image.
struct MaskGrid {
  float x_px = 0, y_px = 0;
  float step_px = 1;  ///< > 0
  std::uint16_t width = 0, height = 0;
};

/// Pixels of a mask that follow each other, row after row, and have one label: 0 outside, or as a contour's.
struct MaskRun {
  std::uint16_t count;  ///< at least 1
  WireLabel label;
};

/// What the tracker says about a pose. Anything but `ok` must not be used for geometry.
enum class PoseStatus : std::uint16_t {
  ok = 0,
  missing = 1,        ///< the tracker reports nothing for this tool
  out_of_view = 2,    ///< markers hidden
  out_of_volume = 3,  ///< outside of the tracker's calibrated volume
  high_error = 4,     ///< the tracker's own error estimate is over its limit
  invalid = 5,        ///< the tracker reports that the value means nothing
};

/// ProbeToReference: p_reference = q * p_probe * q^-1 + t. Frames: probe and reference, mm, right-handed.
/// Of a pose that is not ok the numbers are the last good ones or the identity; they are finite all the same.
struct Pose {
  double qw = 1, qx = 0, qy = 0, qz = 0;  ///< unit quaternion, | |q| - 1 | <= 1e-3
  double tx_mm = 0, ty_mm = 0, tz_mm = 0;
  std::uint64_t time_ns = 0;  ///< device clock, when the tracker measured
  float error_mm = 0;         ///< the tracker's estimate, rms; 0: no estimate
  PoseStatus status = PoseStatus::ok;
};

/// A segmented image and the pose that belongs to it, as views of arrays that somebody else owns: what goes into
/// encode_slice() and what comes out of accept().
struct Slice {
  std::uint64_t time_ns = 0;             ///< device clock, middle of the acquisition
  Pose pose;                             ///< ProbeToReference
  std::uint32_t calibration_id = 0;      ///< which ImageToProbe (pixel -> mm) the image was taken with
  std::span<const Point> points;         ///< [#V] the contours' points; contour i + 1 starts where contour i ends
  std::span<const Contour> contours;     ///< [#C] together they use every point exactly once
  std::span<const Point> field_of_view;  ///< [#F] closed polygon; empty: the whole plane was seen; else at least 3

  /// Instead of contours: a label for every pixel. Since 1.1.
  MaskGrid mask_grid;
  std::span<const MaskRun> mask_runs;  ///< [#R] together width x height pixels; empty: the slice has contours

  [[nodiscard]] bool has_mask() const { return !mask_runs.empty(); }
};

}  // namespace sonoloft::protocol
