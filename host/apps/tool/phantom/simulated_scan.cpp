#include "host/apps/tool/phantom/simulated_scan.h"

#include <utility>

namespace sonoloft::tool {

Result<std::unique_ptr<SimulatedScan>> SimulatedScan::make(const Body& body, const ScanPlan& plan) {
  std::unique_ptr<SimulatedScan> scan(new SimulatedScan);
  auto device = device_sim::SimulatedDevice::make(
      body, plan, [raw = scan.get()](const device_sim::AcquiredSlice& slice) { raw->note(slice); });
  if (!device.value) return fail(ErrorCode::invalid_argument, device.error);
  scan->calibration_ = device::make_calibration(device.value->firmware().calibration).value();
  scan->device_ = std::move(device.value);
  return scan;
}

device_sim::usb::UsbIdentity SimulatedScan::usb_identity() const {
  const device_sim::FirmwareConfig& firmware = device_->firmware();
  return {firmware.serial.data(), device_sim::record_slot_len(firmware.limits)};
}

void SimulatedScan::note(const device_sim::AcquiredSlice& slice) {
  const std::uint64_t index = images_++;
  if (slice.pose.status != protocol::PoseStatus::ok) return;
  sent_.push_back(device::to_delivered(slice, index, calibration_, {}).slice);
}

}  // namespace sonoloft::tool
