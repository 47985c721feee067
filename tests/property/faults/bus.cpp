#include "tests/property/faults/bus.h"

#include <doctest/doctest.h>

#include "device_sim/firmware/firmware.h"
#include "host/device/loopback/loopback_transport.h"
#include "tests/support/wire/wire_slices.h"
#include "tests/usb/usbip/served_transport.h"

namespace sonoloft::test {

std::unique_ptr<device::Transport> connect_loopback(protocol::Port& port) {
  return std::make_unique<device::LoopbackTransport>(port);
}

std::unique_ptr<device::Transport> connect_usbip(protocol::Port& port) {
  return serve_over_usbip(port, {"LOOP-1", device_sim::record_slot_len(kTestLimits)});
}

std::unique_ptr<device::Session> open_session(const Bus& bus, protocol::Port& port) {
  auto session = device::Session::open(bus.connect(port));
  if (!session) FAIL(session.error().message);
  return std::move(*session);
}

}  // namespace sonoloft::test
