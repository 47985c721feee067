#include "protocol/crc32c.h"

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

using sonoloft::protocol::crc32c;

namespace {

std::vector<std::byte> bytes(std::size_t count, auto value_at) {
  std::vector<std::byte> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<std::byte>(value_at(i));
  return result;
}

// One bit at a time, straight from the definition.
std::uint32_t crc32c_bit_by_bit(std::span<const std::byte> message) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const std::byte b : message) {
    crc ^= static_cast<std::uint32_t>(b);
    for (int i = 0; i < 8; ++i) crc = (crc & 1) ? (crc >> 1) ^ 0x82F63B78u : crc >> 1;
  }
  return ~crc;
}

}  // namespace

TEST_CASE("crc32c: the vectors of RFC 3720 B.4 and the check value hold") {
  CHECK(crc32c(bytes(32, [](std::size_t) { return 0; })) == 0x8A9136AA);
  CHECK(crc32c(bytes(32, [](std::size_t) { return 0xFF; })) == 0x62A8AB43);
  CHECK(crc32c(bytes(32, [](std::size_t i) { return i; })) == 0x46DD794E);
  CHECK(crc32c(bytes(32, [](std::size_t i) { return 31 - i; })) == 0x113FDB5C);
  CHECK(crc32c(std::as_bytes(std::span("123456789", 9))) == 0xE3069283);
  CHECK(crc32c({}) == 0);
}

TEST_CASE("crc32c: every length, start and split gives the sum of the definition") {
  const auto message = bytes(100, [](std::size_t i) { return (i * 167 + 13) % 256; });
  int checked = 0;
  for (std::size_t start = 0; start < 9; ++start) {
    for (std::size_t len = 0; start + len <= message.size(); len += 3) {
      const auto part = std::span<const std::byte>(message).subspan(start, len);
      REQUIRE(crc32c(part) == crc32c_bit_by_bit(part));
      const std::size_t split = len / 3;
      REQUIRE(crc32c(part.subspan(split), crc32c(part.first(split))) == crc32c(part));
      ++checked;
    }
  }
  MESSAGE(checked << " pieces");
}
