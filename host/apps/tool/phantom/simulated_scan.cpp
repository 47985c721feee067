#include "host/apps/tool/phantom/simulated_scan.h"

#include <algorithm>
#include <utility>

#include "core/io/slice_files.h"
#include "device_sim/probe/field_of_view.h"
#include "device_sim/probe/trajectory.h"

namespace sonoloft::tool {
namespace {

constexpr std::uint32_t kSlices = 60;
constexpr double kPixelsAlongBody = 1000;
constexpr double kHandsBody_mm = 200;  ///< the length of a body that the hand's own numbers are meant for
constexpr double kFastClock_hz = 30;   ///< the device's clock where it does not pace
constexpr std::uint32_t kMaxPoints = 1u << 16, kMaxContours = 1u << 12;

device_sim::Trajectory trajectory_over(const Body& body, const ScanPlan& plan) {
  if (!body.recorded) {
    device_sim::Hand hand;
    hand.seed = plan.seed;
    hand.tremor_mm *= body.source->bounds().sizes().maxCoeff() / kHandsBody_mm;  // files may have no unit
    return device_sim::freehand_sweep(body.source->bounds(), {plan.slices.value_or(kSlices), {}}, hand);
  }
  const std::size_t slices = std::min<std::size_t>(plan.slices.value_or(kMaxFileSlices), body.recorded->size());
  return {body.recorded->begin(), body.recorded->begin() + static_cast<std::ptrdiff_t>(slices)};
}

device_sim::ProbeOptions probe_options(const Body& body, const ScanPlan& plan,
                                       const device_sim::Trajectory& trajectory) {
  const Eigen::AlignedBox3d bounds = body.source->bounds();
  device_sim::ProbeOptions options;
  options.seed = plan.seed;
  options.rate_hz = plan.rate_hz > 0 ? plan.rate_hz : kFastClock_hz;
  options.pixel_mm = std::clamp(bounds.sizes().maxCoeff() / kPixelsAlongBody, 1e-3, 100.0);
  if (!body.recorded) options.sector = device_sim::covering_sector(bounds, trajectory);
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
  device_sim::LoopbackOptions loopback;
  loopback.firmware.limits = {std::max(kMaxPoints, body.max_points), std::max(kMaxContours, body.max_contours),
                              kMaxLabel};
  loopback.firmware.calibration = calibration_of(*scan->probe_, options.calibration_id);
  if (plan.rate_hz > 0) loopback.rate_hz = plan.rate_hz;
  scan->device_ = std::make_unique<device_sim::LoopbackDevice>(loopback, [raw = scan.get()] { return raw->next(); });
  return scan;
}

const device_sim::AcquiredSlice* SimulatedScan::next() {
  frame_ = probe_->next();
  if (!frame_) return nullptr;
  view_ = frame_->view();
  return &view_;
}

}  // namespace sonoloft::tool
