#include "host/igtl/listener.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string>

namespace sonoloft::igtl {
namespace {

Error refusal(int cause, const std::string& address, std::uint16_t port) {
  const std::string where = "port " + std::to_string(port) + " of " + address;
  if (cause == EADDRNOTAVAIL)
    return {ErrorCode::invalid_argument, address + " is no address of this machine: see `ip address`"};
  if (cause == EADDRINUSE)
    return {ErrorCode::io_failed, where + " is in use: end the program that listens there, or choose another port"};
  if (cause == EACCES) return {ErrorCode::io_failed, where + " needs root: choose one from 1024 on"};
  return {ErrorCode::io_failed, "cannot listen on " + where + ": " + std::strerror(cause)};
}

std::uint16_t port_of(int socket) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  getsockname(socket, reinterpret_cast<sockaddr*>(&bound), &size);
  const bool six = bound.ss_family == AF_INET6;
  return ntohs(six ? reinterpret_cast<const sockaddr_in6&>(bound).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(bound).sin_port);
}

void set(int socket, int level, int option, int value) {
  setsockopt(socket, level, option, &value, sizeof value);
}

}  // namespace

Result<Listener> listen_on(const std::string& address, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0)
    return fail(ErrorCode::invalid_argument,
                "'" + address + "' is no IP address: give one of this machine, 127.0.0.1 or 0.0.0.0 for all of them");
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owned(found, freeaddrinfo);
  const int listener = socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (listener < 0) return tl::unexpected<Error>(refusal(errno, address, port));
  set(listener, SOL_SOCKET, SO_REUSEADDR, 1);
  if (bind(listener, found->ai_addr, found->ai_addrlen) != 0 || listen(listener, SOMAXCONN) != 0) {
    const int cause = errno;
    close(listener);
    return tl::unexpected<Error>(refusal(cause, address, port));
  }
  return Listener{listener, port_of(listener)};
}

int accept_client(int listener, std::chrono::milliseconds patience) {
  constexpr int kSendBuffer = 1 << 18, kAskAfter_s = 10;
  const int client = accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (client < 0) return client;
  set(client, SOL_SOCKET, SO_SNDBUF, kSendBuffer);
  set(client, IPPROTO_TCP, TCP_NODELAY, 1);
  set(client, SOL_SOCKET, SO_KEEPALIVE, 1);
  set(client, IPPROTO_TCP, TCP_KEEPIDLE, kAskAfter_s);
  set(client, IPPROTO_TCP, TCP_KEEPINTVL, kAskAfter_s);
  set(client, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(2 * patience.count()));
  return client;
}

}  // namespace sonoloft::igtl
