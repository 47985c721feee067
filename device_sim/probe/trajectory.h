#pragma once
// Where the probe is at each image:  [TRAJECTORY] -> simulated probe
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

namespace sonoloft::device_sim {

/// FaceToReference of every image, evenly spaced in time. Frame of the face: mm; origin at the apex of the sector, x to
/// the side, y into the body, z along the normal of the image (right-handed).
using Trajectory = std::vector<Eigen::Isometry3d>;

/// The probe stands above the box, on the side of its shortest edge, and moves along its longest.
struct SweepOptions {
  std::uint32_t slices = 100;
  std::optional<double> standoff_mm;  ///< from the apex to the box, below 0 within it; by default half the box's
                                      ///< largest other edge, so that a sector of about 90 degrees sees all of it
};

/// Parallel planes, evenly through the box.
/// @pre   the box is not empty (so for all sweeps)
/// @post  one pose per slice; every pose is rigid (so for all sweeps)
[[nodiscard]] Trajectory linear_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options);

/// The probe stays where it is and tilts from one end of the box to the other: all planes meet in a line.
[[nodiscard]] Trajectory fan_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options);

/// The probe turns by half a turn about its own axis through the middle of the box: all planes meet in this axis.
[[nodiscard]] Trajectory rotation_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options);

/// The hand that holds the probe.
struct Hand {
  std::uint32_t passes = 3;         ///< strokes over the body, in directions 0, 90, 37, 127, 74 ... degrees
  double tilt_deg = 20;             ///< the probe rocks by this to both sides along a stroke, twice
  double tremor_deg = 1.5;          ///< standard deviation per axis
  double tremor_mm = 0.15;          ///< standard deviation per axis
  double tremor_correlation = 0.9;  ///< of one slice's tremor with the last one's, 0 <= value < 1
  std::uint64_t seed = 1;
};

/// Strokes over the body by a hand that tilts, turns and trembles: planes of really different directions.
[[nodiscard]] Trajectory freehand_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options,
                                        const Hand& hand);

/// What a scan of a minute looks like: five passes of parallel planes, two side by side along the box, two across it,
/// one at 37 degrees, each one a fifth of the slices and 0.5 to 1 mm a step: with few slices passes over the middle of
/// the box, with many over all of it. The hand trembles and does not tilt (hand.passes and hand.tilt_deg are not used).
/// @param apart_mm  between passes side by side
[[nodiscard]] Trajectory pass_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options, double apart_mm,
                                    const Hand& hand);

/// The probe stands over the middle of the box and only trembles.
[[nodiscard]] Trajectory still_probe(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options,
                                     const Hand& hand);

}  // namespace sonoloft::device_sim
