#pragma once
// body -> [SIMULATED SCAN: trajectory, probe, firmware, cable] -> port -> ScanSession
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/slice/result.h"
#include "device_sim/port/loopback_device.h"
#include "device_sim/port/usb/usb_device.h"
#include "device_sim/probe/simulated_probe.h"
#include "host/apps/tool/phantom/body.h"
#include "host/device/calibration.h"
#include "protocol/port.h"

namespace sonoloft::tool {

struct ScanPlan {
  std::optional<std::uint32_t>
      slices;  ///< of recorded bodies at most as many as there are; none: 60, of a body with bones 300, or all of them
  double rate_hz = 10;     ///< 0: as fast as the host takes them
  std::uint64_t seed = 1;  ///< of the hand's tremor and of all noise
};

/// A probe that a trembling hand moves over the body, tilting it; recorded slices are sent as they were taken. A body
/// that can be cut anywhere is seen through the sector of the image that just holds it. One with bones is scanned as a
/// patient is: in passes of parallel planes, through a sector that sees a part, with shadows behind the bones, contact
/// lost at the edges, noise of the tracker and of the contours.
class SimulatedScan {
 public:
  /// @error invalid_argument
  [[nodiscard]] static Result<std::unique_ptr<SimulatedScan>> make(const Body& body, const ScanPlan& plan);

  [[nodiscard]] std::size_t slices() const { return probe_->image_count(); }
  /// What was sent so far, in mm, but for images without a good pose. @pre nobody uses the port any more
  [[nodiscard]] const std::vector<TrackedSlice>& sent() const { return sent_; }
  /// @pre whoever uses it is gone before the scan is
  [[nodiscard]] protocol::Port& port() { return device_->port(); }
  /// What it calls itself where it is reached over USB.
  [[nodiscard]] const device_sim::usb::UsbIdentity& usb_identity() const { return usb_identity_; }

 private:
  SimulatedScan() = default;
  const device_sim::AcquiredSlice* next();

  device::Calibration calibration_;
  std::vector<TrackedSlice> sent_;
  device_sim::usb::UsbIdentity usb_identity_;
  std::unique_ptr<device_sim::SimulatedProbe> probe_;
  std::optional<device_sim::SimulatedFrame> frame_;
  device_sim::AcquiredSlice view_;
  std::optional<std::uint64_t> clock_offset_ns_;        ///< from the probe's image times to the device's clock
  std::unique_ptr<device_sim::LoopbackDevice> device_;  ///< its thread uses the members above: it goes first
};

}  // namespace sonoloft::tool
