#include "protocol/block.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "protocol/record.h"

using namespace sonoloft::protocol;

namespace {

std::vector<std::byte> encoded(std::uint32_t offset, std::span<const std::byte> data) {
  std::vector<std::byte> bytes(data.size() + kMaxBlockOverhead);
  bytes.resize(encode_block({offset, data}, bytes));
  return bytes;
}

}  // namespace

TEST_CASE("block: data of any length come back, and no length is a multiple of 64") {
  std::vector<std::byte> data;
  for (std::uint32_t len = 0; len < 300; ++len) {
    const auto bytes = encoded(7 * len, data);
    CHECK(bytes.size() % kPacketDivisor != 0);
    const auto block = parse_block(bytes);
    REQUIRE(block);
    CHECK(block->offset == 7 * len);
    CHECK(std::equal(block->data.begin(), block->data.end(), data.begin(), data.end()));
    data.push_back(static_cast<std::byte>(len * 37));
  }
}

TEST_CASE("block: one that was cut, extended, or altered in any bit of what it says, is none") {
  const std::vector<std::byte> data(48, std::byte{0x5A});  // with 16 bytes of padding
  const auto bytes = encoded(96, data);
  for (std::size_t len = 0; len < bytes.size(); ++len) CHECK_FALSE(parse_block(std::span(bytes).first(len)));
  auto longer = bytes;
  longer.push_back(std::byte{0});
  CHECK_FALSE(parse_block(longer));
  for (std::size_t bit = 0; bit < 8 * (sizeof(BlockHeader) + data.size()); ++bit) {
    auto altered = bytes;
    altered[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    CHECK_FALSE(parse_block(altered));
  }
}
