#pragma once
#include <string>

#include "core/slice/result.h"

namespace sonoloft::device {

/// What libusb answered (LIBUSB_ERROR_...), as an error with its remedy. transport_closed where the device is gone,
/// timed_out, else io_failed.
[[nodiscard]] tl::unexpected<Error> usb_error(int status, const std::string& what);

/// How a transfer ended (LIBUSB_TRANSFER_..., anything but completed), in the same way.
[[nodiscard]] tl::unexpected<Error> transfer_error(int status, const std::string& what);

}  // namespace sonoloft::device
