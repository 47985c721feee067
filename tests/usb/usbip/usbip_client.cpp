#include "tests/usb/usbip/usbip_client.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace sonoloft::test {
namespace {

constexpr std::size_t kDeviceLen = 312, kCommandLen = 48;
constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3;
constexpr std::uint32_t kOut = 0, kIn = 1;

void put(std::vector<std::byte>& out, std::initializer_list<std::uint32_t> numbers) {
  for (const std::uint32_t n : numbers) {
    for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<std::byte>(n >> shift & 0xFF));
  }
}

std::uint32_t number(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (const std::byte b : bytes.subspan(at, 4)) value = value << 8 | std::to_integer<std::uint32_t>(b);
  return value;
}

}  // namespace

UsbipClient::UsbipClient(std::uint16_t tcp_port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(tcp_port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    throw std::system_error(errno, std::generic_category(), "no USB/IP server");
  }
  const int on = 1;
  setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  const timeval patience{60, 0};
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
}

UsbipClient::~UsbipClient() {
  close(socket_);
}

void UsbipClient::send(std::span<const std::byte> message) {
  auto bytes = message.first(std::min(message.size(), left_));
  left_ -= bytes.size();
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // closed by the server: shows when receiving
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  if (left_ == 0) shut_down();
}

std::optional<std::vector<std::byte>> UsbipClient::receive(std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size != 0 && recv(socket_, bytes.data(), size, MSG_WAITALL) != static_cast<ssize_t>(size)) return std::nullopt;
  return bytes;
}

void UsbipClient::shut_down() {
  shutdown(socket_, SHUT_RDWR);
}

std::vector<std::byte> UsbipClient::list() {
  std::vector<std::byte> request;
  put(request, {0x01118005, 0});
  send(request);
  return receive(12 + kDeviceLen + 4).value_or(std::vector<std::byte>{});
}

std::uint32_t UsbipClient::import(const char* bus_id) {
  std::vector<std::byte> request;
  put(request, {0x01118003, 0});
  request.resize(8 + 32);
  std::memcpy(request.data() + 8, bus_id, std::string_view(bus_id).size());
  send(request);
  const auto reply = receive(8);
  const std::uint32_t status = reply ? number(*reply, 4) : 0;
  if (status == 0 && (!reply || !receive(kDeviceLen))) throw std::runtime_error("the USB/IP server closed");
  return status;
}

std::uint32_t UsbipClient::command(std::uint32_t code, std::uint32_t direction, std::uint32_t endpoint,
                                   std::uint32_t third, std::uint32_t length, std::span<const std::byte> setup,
                                   std::span<const std::byte> data) {
  if (code == kSubmit && direction == kIn) {
    const std::lock_guard lock(mutex_);
    inbound_.insert(next_seqnum_);
  }
  std::vector<std::byte> bytes;
  put(bytes, {code, next_seqnum_, 0x00010002, direction, endpoint, third, length, 0, 0xFFFFFFFF, 0});
  bytes.insert(bytes.end(), setup.begin(), setup.end());
  bytes.resize(kCommandLen);
  bytes.insert(bytes.end(), data.begin(), data.end());
  send(bytes);
  return next_seqnum_++;
}

std::uint32_t UsbipClient::submit(std::uint32_t endpoint, std::uint32_t length) {
  return command(kSubmit, kIn, endpoint, 0, length, {}, {});
}

std::uint32_t UsbipClient::submit_out(std::uint32_t endpoint, std::span<const std::byte> data) {
  return command(kSubmit, kOut, endpoint, 0, static_cast<std::uint32_t>(data.size()), {}, data);
}

std::uint32_t UsbipClient::submit_control(std::uint8_t request_type, std::uint8_t request, std::uint16_t value,
                                          std::uint16_t length, std::span<const std::byte> data, std::uint16_t index) {
  std::array<std::byte, 8> setup{};
  setup[0] = std::byte{request_type};
  setup[1] = std::byte{request};
  std::memcpy(setup.data() + 2, &value, 2);
  std::memcpy(setup.data() + 4, &index, 2);
  std::memcpy(setup.data() + 6, &length, 2);
  return command(kSubmit, (request_type & 0x80) != 0 ? kIn : kOut, 0, 0, length, setup, data);
}

std::uint32_t UsbipClient::unlink(std::uint32_t seqnum) {
  return command(kUnlink, kOut, 0, seqnum, 0, {}, {});
}

std::optional<UsbipClient::Reply> UsbipClient::next_reply() {
  const auto header = receive(kCommandLen);
  if (!header) return std::nullopt;
  Reply reply{
      number(*header, 0), number(*header, 4), static_cast<std::int32_t>(number(*header, 20)), {}, number(*header, 24)};
  // What was sent to the device is not sent back; its length is.
  {
    const std::lock_guard lock(mutex_);
    if (reply.command != kSubmitted || inbound_.erase(reply.seqnum) == 0) return reply;
  }
  auto data = receive(reply.actual_length);
  if (!data) return std::nullopt;
  reply.data = std::move(*data);
  return reply;
}

}  // namespace sonoloft::test
