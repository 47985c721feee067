#pragma once
#include <memory>

#include "device_sim/port/usb/usb_device.h"
#include "host/device/transport.h"
#include "protocol/port.h"

namespace sonoloft::test {

/// A host's way to a port through the simulated USB device, a USB/IP server of its own, and TCP.
/// @pre `port` outlives the transport, and is used by nobody else
std::unique_ptr<device::Transport> serve_over_usbip(protocol::Port& port, const device_sim::usb::UsbIdentity& identity);

}  // namespace sonoloft::test
