#include "device_sim/probe/simulated_probe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "device_sim/probe/label_noise.h"

namespace sonoloft::device_sim {
namespace {

bool rigid(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  return pose.matrix().allFinite() && (r * r.transpose()).isIdentity(1e-6) && r.determinant() > 0;
}

bool within(double value, double low, double high) {
  return value >= low && value <= high;
}

std::string check(const ProbeOptions& o, const SectionSource* source, const Trajectory& trajectory) {
  if (source == nullptr) return "probe: no phantom; name what is to be scanned";
  if (!within(o.rate_hz, 0.01, 10'000)) return "probe: the rate must be 0.01 to 10000 images a second";
  if (!within(o.pixel_mm, 1e-3, 100)) return "probe: the pixel size must be 0.001 to 100 mm";
  if (!rigid(o.face_to_probe)) return "probe: face_to_probe must be a rotation and a translation";
  if (o.sector && !(within(o.sector->near_mm, 0, 1e6) && within(o.sector->far_mm, o.sector->near_mm + 1e-3, 1e6) &&
                    within(o.sector->half_angle_rad, 1e-3, std::numbers::pi / 2)))
    return "probe: a sector needs 0 <= near < far and a half angle below 90 degrees";
  if (!o.sector && !o.shadowing.empty()) return "probe: shadows need a sector; give one";
  if (!o.sector && (o.wrong_share != 0 || o.contact_lost_share != 0))
    return "probe: wrong labels and lost contact need a sector; give one";
  if (!within(o.wrong_share, 0, 0.5) || !within(o.contact_lost_share, 0, 0.5))
    return "probe: wrong labels and lost contact must be 0 to 0.5 of what is seen";
  if (!within(o.wander_images, 1, 1e6)) return "probe: bias and contact must wander over 1 to 1000000 images";
  if (!within(o.tracker_rms_mm, 0, 1000) || !within(o.tracker_bias_mm, 0, 1000) || !within(o.tracker_rms_deg, 0, 180))
    return "probe: the tracker's noise must be 0 to 1000 mm and 0 to 180 degrees";
  if (!within(o.dropout_share, 0, 0.5) || !within(o.dropout_images, 1, 1e6))
    return "probe: dropouts must be 0 to 0.5 of the images, in stretches of 1 image or more";
  if (!within(o.contour_rms_mm, 0, 1000) || !within(o.contour_correlation_mm, 1e-3, 1e6))
    return "probe: the contours' noise must be 0 to 1000 mm and correlated over 0.001 mm or more";
  for (std::size_t i = 0; i < trajectory.size(); ++i)
    if (!rigid(trajectory[i]))
      return "probe: pose " + std::to_string(i) + " of the trajectory is not rigid; leave it out";
  return {};
}

}  // namespace

Eigen::Isometry3d default_face_to_probe() {
  Eigen::Isometry3d pose(Eigen::Translation3d(12, 85, -20));
  pose.rotate(Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, -1).normalized()));
  return pose;
}

AcquiredSlice SimulatedFrame::view() const {
  AcquiredSlice slice;
  slice.time_ns = time_ns;
  slice.pose = pose;
  slice.calibration_id = calibration_id;
  slice.points = points;
  slice.contours = contours;
  slice.field_of_view = field_of_view;
  slice.mask_grid = mask.grid;
  slice.mask_runs = mask.runs;
  return slice;
}

Made<SimulatedProbe> SimulatedProbe::make(ProbeOptions options, std::shared_ptr<const SectionSource> source,
                                          Trajectory trajectory) {
  std::string error = check(options, source.get(), trajectory);
  if (!error.empty()) return {nullptr, std::move(error)};
  return {
      std::unique_ptr<SimulatedProbe>(new SimulatedProbe(std::move(options), std::move(source), std::move(trajectory))),
      {}};
}

SimulatedProbe::SimulatedProbe(ProbeOptions options, std::shared_ptr<const SectionSource> source, Trajectory trajectory)
    : options_(std::move(options)),
      source_(std::move(source)),
      trajectory_(std::move(trajectory)),
      tracker_noise_(options_.seed, 1),
      dropouts_(options_.seed, 2),
      contour_noise_(options_.seed, 3),
      bias_noise_(options_.seed, 4),
      contact_noise_(options_.seed, 5),
      label_noise_(options_.seed, 6),
      bias_(bias_noise_),
      contact_(contact_noise_) {
  if (!options_.sector) return;
  // The image begins where the sector does, so that pixels inside of it are not negative.
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : device_sim::field_of_view(*options_.sector, {}, {})) box.extend(p);
  origin_mm_ = box.min();
  constexpr double kMargin_mm = 1, kLargestNoise = 6;  // beyond what noise may move into the sector
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kMargin_mm + kLargestNoise * options_.contour_rms_mm);
  window_mm_ = {box.min() - margin, box.max() + margin};
}

Eigen::Matrix<double, 3, 4> SimulatedProbe::image_to_probe() const {
  Eigen::Matrix<double, 3, 4> matrix;
  matrix.leftCols<3>() = options_.face_to_probe.linear() * options_.pixel_mm;
  matrix.col(3) = options_.face_to_probe * Eigen::Vector3d(origin_mm_.x(), origin_mm_.y(), 0);
  return matrix;
}

std::optional<SimulatedFrame> SimulatedProbe::next() {
  if (next_index_ == trajectory_.size()) return std::nullopt;
  const Eigen::Isometry3d& face_to_reference = trajectory_[next_index_];
  SimulatedFrame frame;
  frame.index = next_index_++;
  frame.time_ns = static_cast<std::uint64_t>(std::llround(static_cast<double>(frame.index) * 1e9 / options_.rate_hz));
  frame.calibration_id = options_.calibration_id;
  frame.true_image_to_reference = face_to_reference * Eigen::Translation3d(origin_mm_.x(), origin_mm_.y(), 0);
  frame.pose = track(face_to_reference * options_.face_to_probe.inverse(), frame.time_ns);
  add_image(options_.sector ? source_->section_in(window_mm_, face_to_reference) : source_->section(face_to_reference),
            frame);
  const double correlation = std::exp(-1 / options_.wander_images);
  bias_.step(correlation, bias_noise_);
  contact_.step(correlation, contact_noise_);
  return frame;
}

/// The square of a normal number is small most of the time and large at times, as a lifted edge of the probe is; its
/// mean is 1.
Contact SimulatedProbe::contact() const {
  constexpr double kMostOfAnEdge = 0.45;
  const auto lost = [&](double z) { return std::min(kMostOfAnEdge, options_.contact_lost_share / 2 * z * z); };
  return {lost(contact_.value().x()), 1 - lost(contact_.value().y())};
}

/// Segments a section, given in the frame of the face.
void SimulatedProbe::add_image(PhantomSection section, SimulatedFrame& frame) {
  constexpr double kDiscOfDepth = 1.0 / 25;
  const auto pixel = [&](const Eigen::Vector2d& p) -> protocol::Point {
    const Eigen::Vector2d px = (p - origin_mm_) / options_.pixel_mm;
    return {static_cast<float>(px.x()), static_cast<float>(px.y())};
  };
  std::vector<Eigen::Vector2d> seen = section.field_of_view;
  if (options_.sector) seen = device_sim::field_of_view(*options_.sector, section, options_.shadowing, contact());
  for (const Eigen::Vector2d& p : seen) frame.field_of_view.push_back(pixel(p));

  const Displacement error(options_.contour_rms_mm, options_.contour_correlation_mm, contour_noise_);
  if (options_.contour_rms_mm > 0)
    for (Eigen::Vector2d& p : section.points) p += error.at(p);
  if (options_.wrong_share > 0)
    add_wrong_discs(options_.wrong_share, kDiscOfDepth * options_.sector->far_mm, seen, label_noise_, section);
  for (const SectionLoop& loop : section.loops) {
    const auto points = std::span(section.points).subspan(loop.first, loop.count);
    if (!seen.empty() && !overlaps(points, seen)) continue;
    const auto flags = static_cast<std::uint16_t>(loop.hole ? kHoleFlag : 0);
    frame.contours.push_back({static_cast<std::uint32_t>(frame.points.size()), loop.count, loop.label, flags});
    for (const Eigen::Vector2d& p : points) frame.points.push_back(pixel(p));
  }
  if (options_.mask_pixels == 0) return;
  frame.mask = paint_mask(frame.points, frame.contours, frame.field_of_view, options_.mask_pixels);
  frame.points.clear();
  frame.contours.clear();
}

protocol::Pose SimulatedProbe::track(const Eigen::Isometry3d& probe_to_reference, std::uint64_t time_ns) {
  // Both are drawn for every image: where the poses drop out does not depend on how noisy they are, and vice versa.
  const Eigen::Vector3d shift = tracker_noise_.normal3() * (options_.tracker_rms_mm / std::sqrt(3.0));
  const Eigen::Vector3d turn =
      tracker_noise_.normal3() * (options_.tracker_rms_deg * std::numbers::pi / 180 / std::sqrt(3.0));
  const double share = options_.dropout_share;
  const double change = (tracked_ ? share / (1 - share) : 1) / options_.dropout_images;
  if (dropouts_.uniform() < change) tracked_ = !tracked_;
  if (!tracked_) {
    ++dropped_poses_;
    protocol::Pose pose = last_good_pose_;
    pose.status = PoseStatus::out_of_view;
    return pose;
  }
  Eigen::Quaterniond q(probe_to_reference.linear());
  if (turn.norm() > 0) q = q * Eigen::AngleAxisd(turn.norm(), turn.normalized());
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const Eigen::Vector3d bias = options_.tracker_bias_mm * bias_.value() / std::sqrt(3 + bias_.value().squaredNorm());
  const Eigen::Vector3d t = probe_to_reference.translation() + shift + bias;
  last_good_pose_ = {
      q.w(),         q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), time_ns, static_cast<float>(options_.tracker_rms_mm),
      PoseStatus::ok};
  return last_good_pose_;
}

}  // namespace sonoloft::device_sim
