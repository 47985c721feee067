#include "device_sim/port/local_listener.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace sonoloft::device_sim {

LocalListener listen_locally(std::uint16_t port) {
  constexpr int kBacklog = 16;
  sockaddr_in address{};
  socklen_t len = sizeof address;
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(socket, generic, len) != 0 || listen(socket, kBacklog) != 0 || getsockname(socket, generic, &len) != 0) {
    const std::string cause = std::strerror(errno);
    close(socket);
    return {-1, 0,
            "TCP port " + std::to_string(port) + " cannot be served: " + cause +
                ": stop what uses it, or give another one"};
  }
  return {socket, ntohs(address.sin_port), {}};
}

int accept_client(int listener) {
  const int socket = accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  const int on = 1;
  if (socket >= 0) setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return socket;
}

}  // namespace sonoloft::device_sim
