#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/slice/result.h"
#include "host/device/usb/usb_context.h"
#include "host/device/usb/usb_handle.h"

namespace sonoloft::device {

/// Calls `visit` for every probe on the bus until it says false.
/// @error io_failed
[[nodiscard]] Result<void> each_probe(const UsbContext& context,
                                      const std::function<bool(libusb_device*, const UsbInterface&)>& visit);

/// Bus and ports, e.g. "1-2.4".
[[nodiscard]] std::string location(libusb_device* device);

[[nodiscard]] int speed_mbit(libusb_device* device);

struct FoundProbe {
  std::unique_ptr<UsbHandle> handle;
  std::string serial;
};

/// Opens the probe with this serial number, or the only one when it is empty.
/// @error device_not_found, and those of UsbHandle::open() and serial() of the only candidate
[[nodiscard]] Result<FoundProbe> find_probe(std::string_view serial);

}  // namespace sonoloft::device
