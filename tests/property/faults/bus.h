#pragma once
#include <array>
#include <memory>

#include "host/device/session.h"
#include "host/device/transport.h"
#include "protocol/port.h"

namespace sonoloft::test {

/// What lies between a port and a host. A device on it is as loopback_options() has it.
struct Bus {
  const char* name;
  /// @pre `port` outlives the transport, and is used by nobody else
  std::unique_ptr<device::Transport> (*connect)(protocol::Port& port);
  int plug_cycles;  ///< as many as it is to stand
};

std::unique_ptr<device::Transport> connect_loopback(protocol::Port& port);
/// The simulated USB device, its server, TCP, and a host's end of USB/IP.
std::unique_ptr<device::Transport> connect_usbip(protocol::Port& port);

inline constexpr std::array<Bus, 2> kBuses{{{"loopback", connect_loopback, 10'000}, {"USB/IP", connect_usbip, 100}}};

std::unique_ptr<device::Session> open_session(const Bus& bus, protocol::Port& port);

}  // namespace sonoloft::test
