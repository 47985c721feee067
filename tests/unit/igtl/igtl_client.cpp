#include "tests/unit/igtl/igtl_client.h"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>

namespace sonoloft::test {
namespace {

constexpr std::size_t kHeader = 58, kExtended = 12;

void append_text(Bytes& bytes, const std::string& text, std::size_t size) {
  REQUIRE(text.size() <= size);
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  bytes.resize(bytes.size() + size - text.size());
}

std::string text(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) {
    if (b == std::byte{0}) break;
    text += static_cast<char>(b);
  }
  return text;
}

}  // namespace

std::uint64_t ecma_crc(std::span<const std::byte> bytes) {
  std::uint64_t crc = 0;
  for (const std::byte b : bytes) {
    crc ^= static_cast<std::uint64_t>(b) << 56;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 63 != 0 ? crc << 1 ^ 0x42F0E1EBA9EA3693ull : crc << 1;
  }
  return crc;
}

void append_big_endian(Bytes& bytes, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<std::byte>(value >> 8 * i & 0xFF));
}

std::uint64_t big_endian(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  REQUIRE(at + size <= bytes.size());
  std::uint64_t value = 0;
  for (const std::byte b : bytes.subspan(at, size)) value = value << 8 | static_cast<std::uint64_t>(b);
  return value;
}

float big_endian_float(std::span<const std::byte> bytes, std::size_t at) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(big_endian(bytes, at, 4)));
}

Bytes message(const std::string& type, const std::string& device, const Bytes& content, int version) {
  Bytes body;
  if (version >= 2) {
    append_big_endian(body, kExtended, 2);
    append_big_endian(body, 2, 2);
    append_big_endian(body, 0, 4);
    append_big_endian(body, 1, 4);
  }
  body.insert(body.end(), content.begin(), content.end());
  if (version >= 2) append_big_endian(body, 0, 2);
  Bytes bytes;
  append_big_endian(bytes, static_cast<std::uint64_t>(version), 2);
  append_text(bytes, type, 12);
  append_text(bytes, device, 20);
  append_big_endian(bytes, 0, 8);
  append_big_endian(bytes, body.size(), 8);
  append_big_endian(bytes, ecma_crc(body), 8);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

std::optional<Received> parse(std::span<const std::byte> bytes, std::size_t& size) {
  if (bytes.size() < kHeader) return std::nullopt;
  size = kHeader + big_endian(bytes, 42, 8);
  if (bytes.size() < size) return std::nullopt;
  const auto body = bytes.subspan(kHeader, size - kHeader);
  CHECK(big_endian(bytes, 50, 8) == ecma_crc(body));
  Received received{static_cast<int>(big_endian(bytes, 0, 2)),
                    text(bytes.subspan(2, 12)),
                    text(bytes.subspan(14, 20)),
                    big_endian(bytes, 34, 8),
                    {}};
  std::size_t before = 0, after = 0;
  if (received.version >= 2) {
    before = big_endian(body, 0, 2);
    after = big_endian(body, 2, 2) + big_endian(body, 4, 4);
    CHECK(before == kExtended);
    CHECK(after == 2);
    CHECK(big_endian(body, body.size() - 2, 2) == 0);
  }
  const auto content = body.subspan(before, body.size() - before - after);
  received.content.assign(content.begin(), content.end());
  return received;
}

Polydata polydata(std::span<const std::byte> content) {
  std::array<std::size_t, 10> counts;  // points; vertices, lines, polygons, strips each with their bytes; attributes
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = big_endian(content, 4 * i, 4);
  for (const int absent : {1, 2, 3, 4, 7, 8}) CHECK(counts[static_cast<std::size_t>(absent)] == 0);
  REQUIRE(counts[6] == 16 * counts[5]);
  REQUIRE(counts[9] == 1);
  Polydata data;
  std::size_t at = 40;
  for (std::size_t i = 0; i < counts[0]; ++i, at += 12)
    data.points.push_back(
        {big_endian_float(content, at), big_endian_float(content, at + 4), big_endian_float(content, at + 8)});
  for (std::size_t i = 0; i < counts[5]; ++i) {
    REQUIRE(big_endian(content, at, 4) == 3);
    auto& triangle = data.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      triangle[k] = static_cast<std::uint32_t>(big_endian(content, at + 4 + 4 * k, 4));
    at += 16;
  }
  CHECK(big_endian(content, at, 2) == 0x0001);  // a scalar of every point, one number
  CHECK(big_endian(content, at + 2, 4) == counts[0]);
  data.scalars = text(content.subspan(at + 6));
  at += 6 + data.scalars.size() + 1 + (data.scalars.size() + 1) % 2;
  for (; at < content.size(); at += 4) data.values.push_back(big_endian_float(content, at));
  return data;
}

IgtlClient::IgtlClient(std::uint16_t port, int receive_buffer) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  if (receive_buffer > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
}

IgtlClient::~IgtlClient() {
  close(socket_);
}

bool IgtlClient::send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

std::optional<Received> IgtlClient::receive(std::chrono::milliseconds limit) {
  const auto until = std::chrono::steady_clock::now() + limit;
  for (;;) {
    std::size_t size = 0;
    if (auto received = parse(received_, size)) {
      received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(size));
      return received;
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    pollfd polled{socket_, POLLIN, 0};
    if (left.count() < 0 || poll(&polled, 1, static_cast<int>(left.count())) <= 0) return std::nullopt;
    std::array<std::byte, 1 << 16> part;
    const ssize_t count = recv(socket_, part.data(), part.size(), 0);
    if (count <= 0) return std::nullopt;
    received_.insert(received_.end(), part.begin(), part.begin() + count);
  }
}

std::optional<Received> IgtlClient::receive(const std::string& type) {
  auto received = receive();
  while (received && received->type != type) received = receive();
  return received;
}

bool IgtlClient::closed() {
  std::array<std::byte, 1 << 16> part;
  for (;;) {
    pollfd polled{socket_, POLLIN, 0};
    if (poll(&polled, 1, 60'000) <= 0) return false;
    if (recv(socket_, part.data(), part.size(), 0) <= 0) return true;
  }
}

void IgtlClient::vanish() {
  const linger at_once{1, 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(socket_);
  socket_ = -1;
}

}  // namespace sonoloft::test
