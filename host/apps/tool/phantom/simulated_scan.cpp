#include "host/apps/tool/phantom/simulated_scan.h"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <utility>

#include "core/io/slices/slice_files.h"
#include "device_sim/probe/field_of_view.h"
#include "device_sim/probe/trajectory.h"

namespace sonoloft::tool {
namespace {

constexpr std::uint32_t kSlices = 60, kPatientsSlices = 300;
constexpr device_sim::Sector kAbdominalProbe{8, 110, 35 * std::numbers::pi / 180};
constexpr double kSkinToBone_mm = 8, kPassesApart_mm = 40;
constexpr double kPixelsAlongBody = 1000;
constexpr double kHandsBody_mm = 200;  ///< the length of a body that the hand's own numbers are meant for
constexpr double kFastClock_hz = 30;   ///< the device's clock where it does not pace
constexpr std::uint32_t kMaxPoints = 1u << 16, kMaxContours = 1u << 12;

device_sim::Trajectory trajectory_over(const Body& body, const ScanPlan& plan) {
  if (!body.recorded) {
    device_sim::Hand hand;
    hand.seed = plan.seed;
    if (!body.bones.empty())
      return device_sim::pass_sweep(body.source->bounds(), {plan.slices.value_or(kPatientsSlices), kSkinToBone_mm},
                                    kPassesApart_mm, hand);
    hand.tremor_mm *= body.source->bounds().sizes().maxCoeff() / kHandsBody_mm;  // files may have no unit
    return device_sim::freehand_sweep(body.source->bounds(), {plan.slices.value_or(kSlices), {}}, hand);
  }
  const std::size_t slices = std::min<std::size_t>(plan.slices.value_or(kMaxFileSlices), body.recorded->size());
  return {body.recorded->begin(), body.recorded->begin() + static_cast<std::ptrdiff_t>(slices)};
}

void add_patient(const Body& body, device_sim::ProbeOptions& options) {
  options.sector = kAbdominalProbe;
  options.shadowing = body.bones;
  options.tracker_rms_mm = options.tracker_rms_deg = 0.2;
  options.contour_rms_mm = 0.3;
  options.contact_lost_share = 0.05;
}

device_sim::ProbeOptions probe_options(const Body& body, const ScanPlan& plan,
                                       const device_sim::Trajectory& trajectory) {
  const Eigen::AlignedBox3d bounds = body.source->bounds();
  device_sim::ProbeOptions options;
  options.seed = plan.seed;
  options.rate_hz = plan.rate_hz > 0 ? plan.rate_hz : kFastClock_hz;
  options.pixel_mm = std::clamp(bounds.sizes().maxCoeff() / kPixelsAlongBody, 1e-3, 100.0);
  if (!body.bones.empty())
    add_patient(body, options);
  else if (!body.recorded)
    options.sector = device_sim::covering_sector(bounds, trajectory);
  return options;
}

protocol::CalibrationMessage calibration_of(const device_sim::SimulatedProbe& probe, std::uint32_t id) {
  protocol::CalibrationMessage message{};
  message.id = id;
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = probe.image_to_probe();
  std::copy_n(rows.data(), rows.size(), message.image_to_probe);
  return message;
}

}  // namespace

Result<std::unique_ptr<SimulatedScan>> SimulatedScan::make(const Body& body, const ScanPlan& plan) {
  device_sim::Trajectory trajectory = trajectory_over(body, plan);
  const device_sim::ProbeOptions options = probe_options(body, plan, trajectory);
  auto probe = device_sim::SimulatedProbe::make(options, body.source, std::move(trajectory));
  if (!probe.value) return fail(ErrorCode::invalid_argument, probe.error);

  std::unique_ptr<SimulatedScan> scan(new SimulatedScan);
  scan->probe_ = std::move(probe.value);
  const protocol::CalibrationMessage calibration = calibration_of(*scan->probe_, options.calibration_id);
  scan->calibration_ = device::make_calibration(calibration).value();
  device_sim::LoopbackOptions loopback;
  loopback.firmware.limits = {std::max(kMaxPoints, body.max_points), std::max(kMaxContours, body.max_contours),
                              kMaxLabel};
  loopback.firmware.calibration = calibration;
  if (plan.rate_hz > 0) loopback.rate_hz = plan.rate_hz;
  scan->usb_identity_ = {loopback.firmware.serial.data(), device_sim::record_slot_len(loopback.firmware.limits)};
  scan->device_ = std::make_unique<device_sim::LoopbackDevice>(loopback, [raw = scan.get()] { return raw->next(); });
  return scan;
}

const device_sim::AcquiredSlice* SimulatedScan::next() {
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
  if (view_.pose.status == protocol::PoseStatus::ok)
    sent_.push_back(device::to_delivered(view_, frame_->index, calibration_, {}).slice);
  return &view_;
}

}  // namespace sonoloft::tool
