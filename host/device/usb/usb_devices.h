#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/slice/result.h"
#include "protocol/record.h"

namespace sonoloft::device {

/// A probe on the bus, open or not.
struct UsbDeviceInfo {
  std::string location;          ///< bus and ports, e.g. "1-2.4": stays while it is plugged in
  std::string serial;            ///< empty where it could not be asked
  int speed_mbit = 0;            ///< as negotiated; 0: unknown
  protocol::Version version;     ///< of the wire, by the device's descriptor
  std::optional<Error> problem;  ///< why it could not be asked
};

/// All probes that are plugged in. Each is opened for a moment to read its serial number, and nothing else of it is
/// touched: another program may be using it. @error io_failed (no USB here) @cost milliseconds a probe
[[nodiscard]] Result<std::vector<UsbDeviceInfo>> list_usb_devices();

}  // namespace sonoloft::device
