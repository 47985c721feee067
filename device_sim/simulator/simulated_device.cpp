#include "device_sim/simulator/simulated_device.h"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <utility>

#include "device_sim/probe/field_of_view.h"

namespace sonoloft::device_sim {
namespace {

constexpr std::uint32_t kSlices = 60, kPatientsSlices = 300;
constexpr Sector kAbdominalProbe{8, 110, 35 * std::numbers::pi / 180};
constexpr double kSkinToBone_mm = 8, kPassesApart_mm = 40;
constexpr double kPixelsAlongSubject = 1000;
constexpr double kHandsSubject_mm = 200;  ///< the length of a subject that the hand's own numbers are meant for
constexpr double kFastClock_hz = 30;      ///< the device's clock where it does not pace
constexpr std::uint32_t kMaxPoints = 1u << 16, kMaxContours = 1u << 12;
constexpr std::uint16_t kMaskPixels = 512;
constexpr std::uint32_t kMaxMaskRuns = 1u << 17, kMaxMaskPixels = std::uint32_t{kMaskPixels} * kMaskPixels;

Trajectory trajectory_over(const Subject& subject, const ScanPlan& plan) {
  if (subject.recorded) {
    const auto& all = *subject.recorded;
    const std::size_t slices = std::min<std::size_t>(plan.slices.value_or(~0u), all.size());
    return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(slices)};
  }
  const Eigen::AlignedBox3d bounds = subject.source->bounds();
  Hand hand;
  hand.seed = plan.seed;
  if (!subject.bones.empty())
    return pass_sweep(bounds, {plan.slices.value_or(kPatientsSlices), kSkinToBone_mm}, kPassesApart_mm, hand);
  hand.tremor_mm *= bounds.sizes().maxCoeff() / kHandsSubject_mm;  // files may have no unit
  return freehand_sweep(bounds, {plan.slices.value_or(kSlices), {}}, hand);
}

void add_patient(const Subject& subject, ProbeOptions& options) {
  options.sector = kAbdominalProbe;
  options.shadowing = subject.bones;
  options.tracker_rms_mm = options.tracker_rms_deg = 0.2;
  options.contour_rms_mm = 0.3;
  options.contact_lost_share = 0.05;
}

ProbeOptions probe_options(const Subject& subject, const ScanPlan& plan, const Trajectory& trajectory) {
  const Eigen::AlignedBox3d bounds = subject.source->bounds();
  ProbeOptions options;
  options.seed = plan.seed;
  options.rate_hz = plan.rate_hz > 0 ? plan.rate_hz : kFastClock_hz;
  if (plan.masks) options.mask_pixels = kMaskPixels;
  options.pixel_mm = std::clamp(bounds.sizes().maxCoeff() / kPixelsAlongSubject, 1e-3, 100.0);
  if (!subject.bones.empty())
    add_patient(subject, options);
  else if (!subject.recorded)
    options.sector = covering_sector(bounds, trajectory);
  return options;
}

FirmwareConfig firmware_for(const Subject& subject, const SimulatedProbe& probe, std::uint32_t calibration_id) {
  FirmwareConfig config;
  config.limits = {std::max(kMaxPoints, subject.max_points), std::max(kMaxContours, subject.max_contours),
                   kFirstReservedLabel - 1, kMaxMaskRuns, kMaxMaskPixels};
  config.calibration.id = calibration_id;
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = probe.image_to_probe();
  std::copy_n(rows.data(), rows.size(), config.calibration.image_to_probe);
  return config;
}

}  // namespace

Made<SimulatedDevice> SimulatedDevice::make(const Subject& subject, const ScanPlan& plan,
                                            std::function<void(const AcquiredSlice&)> on_slice) {
  if (!subject.source) return {nullptr, "there is nothing to scan: give the subject a source"};
  if (plan.slices == 0) return {nullptr, "a scan of 0 slices: give at least 1"};
  Trajectory trajectory = trajectory_over(subject, plan);
  const ProbeOptions options = probe_options(subject, plan, trajectory);
  auto probe = SimulatedProbe::make(options, subject.source, std::move(trajectory));
  if (!probe.value) return {nullptr, probe.error};

  std::unique_ptr<SimulatedDevice> made(new SimulatedDevice);
  made->on_slice_ = std::move(on_slice);
  made->probe_ = std::move(probe.value);
  made->firmware_ = firmware_for(subject, *made->probe_, options.calibration_id);
  made->firmware_.blobs = &made->blobs_;
  LoopbackOptions loopback;
  loopback.firmware = made->firmware_;
  if (plan.rate_hz > 0) loopback.rate_hz = plan.rate_hz;
  made->device_ = std::make_unique<LoopbackDevice>(loopback, [raw = made.get()] { return raw->next(); });
  return {std::move(made), {}};
}

const AcquiredSlice* SimulatedDevice::next() {
  frame_ = probe_->next();
  if (!frame_) return nullptr;
  view_ = frame_->view();
  // The probe's images count from 0, the device's clock is the steady one: the first image is taken now.
  if (!clock_offset_ns_) {
    const std::chrono::nanoseconds now = std::chrono::steady_clock::now().time_since_epoch();
    clock_offset_ns_ = static_cast<std::uint64_t>(now.count()) - view_.time_ns;
  }
  view_.time_ns += *clock_offset_ns_;
  view_.pose.time_ns += *clock_offset_ns_;
  if (on_slice_) on_slice_(view_);
  return &view_;
}

}  // namespace sonoloft::device_sim
