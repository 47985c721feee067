#pragma once
// body -> [SIMULATED SCAN: simulated device, what it sent] -> port -> ScanSession
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"
#include "device_sim/port/usb/usb_device.h"
#include "device_sim/simulator/simulated_device.h"
#include "host/apps/tool/phantom/body.h"
#include "host/device/calibration.h"
#include "protocol/port.h"

namespace sonoloft::tool {

using device_sim::ScanPlan;

/// A simulated device that scans a body, and what it sent.
class SimulatedScan {
 public:
  /// @error invalid_argument
  [[nodiscard]] static Result<std::unique_ptr<SimulatedScan>> make(const Body& body, const ScanPlan& plan);

  [[nodiscard]] std::size_t slices() const { return device_->slices(); }
  /// What was sent so far, in mm, but for images without a good pose. @pre nobody uses the port any more
  [[nodiscard]] const std::vector<TrackedSlice>& sent() const { return sent_; }
  /// @pre whoever uses it is gone before the scan is
  [[nodiscard]] protocol::Port& port() { return device_->port(); }
  /// What it calls itself where it is reached over USB.
  [[nodiscard]] device_sim::usb::UsbIdentity usb_identity() const;

 private:
  SimulatedScan() = default;
  void note(const device_sim::AcquiredSlice& slice);

  device::Calibration calibration_;
  std::vector<TrackedSlice> sent_;
  std::uint64_t images_ = 0;
  std::unique_ptr<device_sim::SimulatedDevice> device_;  ///< its thread uses the members above: it goes first
};

}  // namespace sonoloft::tool
