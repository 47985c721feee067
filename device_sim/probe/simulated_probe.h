#pragma once
// Far side of the cable:  phantom, trajectory -> [SIMULATED PROBE] -> AcquiredSlice -> firmware
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "device_sim/firmware/acquired_slice.h"
#include "device_sim/probe/field_of_view.h"
#include "device_sim/probe/phantom.h"
#include "device_sim/probe/random.h"
#include "device_sim/probe/segmentation_mask.h"
#include "device_sim/probe/trajectory.h"
#include "device_sim/probe/wander.h"

namespace sonoloft::device_sim {

/// How the marker body on the probe is mounted against the face of the transducer, as on a real probe: turned and a
/// hand's breadth away.
[[nodiscard]] Eigen::Isometry3d default_face_to_probe();

/// Everything that is wrong with a real acquisition is off by default.
struct ProbeOptions {
  std::uint64_t seed = 1;  ///< of all noise; the same seed gives the same bytes
  double rate_hz = 30;
  double pixel_mm = 0.2;
  std::uint32_t calibration_id = 1;
  Eigen::Isometry3d face_to_probe = default_face_to_probe();
  std::optional<Sector> sector;  ///< none: the whole plane is seen, of a recorded one what was seen of it
  std::vector<Label> shadowing;  ///< labels that sound does not pass, e.g. bone; needs a sector
  double tracker_rms_mm = 0;     ///< length of the error of the marker's position
  double tracker_rms_deg = 0;    ///< angle of the error of its direction
  double tracker_bias_mm = 0;    ///< the marker's position is off by up to this for a while, in a wandering direction
  double dropout_share = 0;      ///< of the images that have no pose, 0 <= value <= 0.5
  double dropout_images = 8;     ///< mean length of a stretch without pose, at least 1
  double contour_rms_mm = 0;     ///< length of the error of a contour's point
  double contour_correlation_mm = 5;  ///< over this distance the error stays much the same
  double wrong_share = 0;             ///< of what is seen, in discs with a wrong label; up to 0.5; needs a sector
  double contact_lost_share = 0;      ///< of the beams, at both edges, on average; up to 0.5; needs a sector
  std::uint16_t mask_pixels = 0;      ///< along the longer side of masks, sent instead of contours; 0: contours
  double wander_images = 40;          ///< over so many images bias and contact stay much the same, at least 1
};

/// An image with its segmentation as the acquisition hands it to the firmware, and the truth behind it.
struct SimulatedFrame {
  std::uint64_t index = 0;
  std::uint64_t time_ns = 0;  ///< device clock
  protocol::Pose pose;        ///< ProbeToReference as tracked
  std::uint32_t calibration_id = 0;
  std::vector<protocol::Point> points;         ///< image, pixels
  std::vector<protocol::Contour> contours;     ///< those that the field of view sees any part of, whole or nearly
  SegmentationMask mask;                       ///< instead of the contours; without runs where they are sent
  std::vector<protocol::Point> field_of_view;  ///< image, pixels; empty: the whole plane

  /// Truth: where the image's plane was. Its frame is the image in mm: pixel times pixel_mm.
  Eigen::Isometry3d true_image_to_reference = Eigen::Isometry3d::Identity();

  /// Views of this frame's arrays; valid as long as the frame stays where it is.
  [[nodiscard]] AcquiredSlice view() const;
};

/// Moves along a trajectory and takes an image at each pose. Threads: one user.
class SimulatedProbe {
 public:
  /// @param source     what is scanned; shared, as its truth outlives the probe
  /// @error an option outside of its range, no source, a pose that is not rigid
  [[nodiscard]] static Made<SimulatedProbe> make(ProbeOptions options, std::shared_ptr<const SectionSource> source,
                                                 Trajectory trajectory);

  /// The next image, none after the last pose. @cost one section; allocates
  [[nodiscard]] std::optional<SimulatedFrame> next();

  /// The calibration: pixel (u, v, 0, 1) -> probe, mm; a rigid motion after a scaling by pixel_mm.
  [[nodiscard]] Eigen::Matrix<double, 3, 4> image_to_probe() const;
  [[nodiscard]] std::size_t image_count() const { return trajectory_.size(); }
  /// Images so far whose pose was not ok.
  [[nodiscard]] std::size_t dropped_poses() const { return dropped_poses_; }
  /// Truth: what is being scanned.
  [[nodiscard]] const SectionSource& truth() const { return *source_; }

 private:
  SimulatedProbe(ProbeOptions options, std::shared_ptr<const SectionSource> source, Trajectory trajectory);
  void add_image(PhantomSection section, SimulatedFrame& frame);
  [[nodiscard]] Contact contact() const;
  [[nodiscard]] protocol::Pose track(const Eigen::Isometry3d& probe_to_reference, std::uint64_t time_ns);

  ProbeOptions options_;
  std::shared_ptr<const SectionSource> source_;
  Trajectory trajectory_;
  Eigen::Vector2d origin_mm_ = Eigen::Vector2d::Zero();  ///< of the image, in the frame of the face
  Eigen::AlignedBox2d window_mm_;                        ///< around the sector, in the frame of the face
  /// Separate streams: one option does not shift another's noise.
  Random tracker_noise_, dropouts_, contour_noise_, bias_noise_, contact_noise_, label_noise_;
  Wander bias_, contact_;
  std::uint64_t next_index_ = 0;
  std::size_t dropped_poses_ = 0;
  bool tracked_ = true;
  protocol::Pose last_good_pose_;
};

}  // namespace sonoloft::device_sim
