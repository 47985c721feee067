#pragma once
#include <cstdint>
#include <string>

namespace sonoloft::device_sim {

/// A TCP socket of 127.0.0.1 that listens.
struct LocalListener {
  int socket;
  std::uint16_t port;
  std::string error;  ///< iff the port cannot be had, and then there is no socket: cause and remedy
};

/// @param port  0: any that is free
[[nodiscard]] LocalListener listen_locally(std::uint16_t port);

/// The next client, whose sends go out at once; neither waits. -1: there is none.
[[nodiscard]] int accept_client(int listener);

}  // namespace sonoloft::device_sim
