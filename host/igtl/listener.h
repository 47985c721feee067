#pragma once
#include <chrono>
#include <cstdint>
#include <string>

#include "core/slice/result.h"

namespace sonoloft::igtl {

struct Listener {
  int socket;          ///< does not block
  std::uint16_t port;  ///< the one that was free where any would do
};

/// @param address  of an interface, as a number
/// @param port     0: any that is free
/// @error invalid_argument (no address of this machine), io_failed (the port is in use, or not for everybody)
[[nodiscard]] Result<Listener> listen_on(const std::string& address, std::uint16_t port);

/// Takes the next client in. @return a socket that does not block, with little room for what is under way, so that a
/// slow reader gets new meshes rather than old ones; its calls fail with ETIMEDOUT when the other machine is silent for
/// about twice the patience. < 0: there is none, or no room for one
[[nodiscard]] int accept_client(int listener, std::chrono::milliseconds patience);

}  // namespace sonoloft::igtl
