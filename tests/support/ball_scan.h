#pragma once
#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <numbers>
#include <vector>

#include "device_sim/port/loopback_device.h"
#include "host/device/loopback/loopback_transport.h"
#include "host/scan/scan_session.h"
#include "tests/support/wire/wire_slices.h"

namespace sonoloft::test {

/// A ball of 20 mm (label 1) around the origin, with one of 10 mm (label 2) in it.
inline constexpr double kBallRadius_mm = 20, kCoreRadius_mm = 10;

inline void add_ring(OwnedWireSlice& slice, double radius_mm, double height_mm, protocol::WireLabel label) {
  constexpr std::uint32_t kPoints = 64;
  constexpr double kPixel_mm = 0.2;
  if (std::abs(height_mm) >= radius_mm) return;
  const double r_px = std::sqrt(radius_mm * radius_mm - height_mm * height_mm) / kPixel_mm;
  slice.contours.push_back({static_cast<std::uint32_t>(slice.points.size()), kPoints, label, 0});
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kPoints;
    slice.points.push_back({static_cast<float>(r_px * std::cos(angle)), static_cast<float>(r_px * std::sin(angle))});
  }
}

/// Slice i of `count`: planes z = h and planes y = h in turn, h from one end of the ball to the other.
inline OwnedWireSlice ball_slice(std::uint32_t i, std::uint32_t count) {
  OwnedWireSlice slice;
  const double h = kBallRadius_mm * ((2.0 * i + 1) / count - 1);
  add_ring(slice, kBallRadius_mm, h, 1);
  add_ring(slice, kCoreRadius_mm, h, 2);
  protocol::Pose& pose = slice.slice.pose;
  if (i % 2 == 0) {
    pose.tz_mm = h;
  } else {  // a quarter turn about x: the image's normal is -y
    pose.qw = pose.qx = std::sqrt(0.5);
    pose.ty_mm = h;
  }
  slice.slice.calibration_id = kTestCalibrationId;
  slice.slice.time_ns = pose.time_ns = 1'000'000ull * (i + 1);
  return slice;
}

inline device_sim::LoopbackOptions ball_device_options() {
  device_sim::LoopbackOptions options;
  options.firmware = {kTestLimits, {"BALL-1"}, {kTestCalibrationId, 0, {0.2, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 1, 0}}};
  return options;
}

/// The slices of the ball, changed by `change`; after the last one, when `endless`, the first again.
inline device_sim::SliceSource ball_source(std::uint32_t count, bool endless = false,
                                           std::function<void(std::uint32_t, OwnedWireSlice&)> change = {}) {
  auto current = std::make_shared<OwnedWireSlice>();
  return [=, next = std::uint32_t{0}]() mutable -> const device_sim::AcquiredSlice* {
    if (next == count && !endless) return nullptr;
    *current = ball_slice(next % count, count);
    if (change) change(next, *current);
    ++next;
    return &current->view();
  };
}

/// Coarse; every slice counts, and few share an update.
inline ScanOptions ball_scan_options() {
  ScanOptions options;
  options.reconstructor.box = {Eigen::Vector3d::Constant(-60), Eigen::Vector3d::Constant(60)};
  options.reconstructor.spacing_mm = 2;
  options.reconstructor.admission = Admission::everything;
  options.reconstructor.device = DeviceChoice::cpu;
  options.stream.mode = device::StreamMode::lossless;
  options.queue_capacity = 2;
  return options;
}

inline std::unique_ptr<ScanSession> open_scan(protocol::Port& port, const ScanOptions& options = ball_scan_options()) {
  auto scan = ScanSession::open(std::make_unique<device::LoopbackTransport>(port), options);
  if (!scan) FAIL(scan.error().message);
  return std::move(*scan);
}

/// Everything that a scan called back with, and ways to wait for it. A wait is false only when it never happens: its
/// limit is far beyond any sensible time.
class ScanInbox {
 public:
  /// @param then  called on the reconstruction thread with every update, after it was kept
  explicit ScanInbox(std::function<void(const MeshUpdate&)> then = {}) : then_(std::move(then)) {}

  ScanCallbacks callbacks() {
    return {[this](std::shared_ptr<const MeshUpdate> update) { take(std::move(update)); },
            [this](const ScanEvent& event) { take(event); }};
  }

  bool wait_for(ScanEventKind kind) {
    return wait([this, kind] { return count_locked(kind) > 0; });
  }
  bool wait_for_updates(std::size_t count) {
    return wait([this, count] { return updates_.size() >= count; });
  }
  /// For the last update to be of full detail, or not to be.
  bool wait_for_full(bool full) {
    return wait([this, full] { return !updates_.empty() && (updates_.back()->detail == Detail::full) == full; });
  }
  std::size_t count(ScanEventKind kind) const {
    const std::lock_guard lock(mutex_);
    return count_locked(kind);
  }
  std::vector<std::shared_ptr<const MeshUpdate>> updates() const {
    const std::lock_guard lock(mutex_);
    return updates_;
  }
  std::vector<ScanEvent> events() const {
    const std::lock_guard lock(mutex_);
    return events_;
  }

 private:
  void take(std::shared_ptr<const MeshUpdate> update) {
    {
      const std::lock_guard lock(mutex_);
      updates_.push_back(update);
      changed_.notify_all();
    }
    if (then_) then_(*update);
  }
  void take(const ScanEvent& event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
    changed_.notify_all();
  }
  template <class Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), condition);
  }
  std::size_t count_locked(ScanEventKind kind) const {
    std::size_t n = 0;
    for (const ScanEvent& event : events_) n += event.kind == kind ? 1 : 0;
    return n;
  }

  const std::function<void(const MeshUpdate&)> then_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::shared_ptr<const MeshUpdate>> updates_;
  std::vector<ScanEvent> events_;
};

}  // namespace sonoloft::test
