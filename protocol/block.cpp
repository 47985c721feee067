#include "protocol/block.h"

#include <algorithm>
#include <cassert>

#include "protocol/command.h"
#include "protocol/crc32c.h"
#include "protocol/record.h"

namespace sonoloft::protocol {
namespace {

std::uint32_t sum_of(const BlockHeader& header, std::span<const std::byte> data) {
  return crc32c(data, crc32c(bytes_of(header).first(offsetof(BlockHeader, crc32c))));
}

std::size_t block_len(std::size_t data_len) {
  const std::size_t len = sizeof(BlockHeader) + data_len;
  return len % kPacketDivisor == 0 ? len + sizeof(BlockHeader) : len;
}

}  // namespace

std::size_t encode_block(const Block& block, std::span<std::byte> out) {
  BlockHeader header{kBlockMagic, block.offset, static_cast<std::uint32_t>(block.data.size()), 0};
  header.crc32c = sum_of(header, block.data);
  const std::size_t len = block_len(block.data.size());
  assert(len <= out.size());
  auto rest = std::copy_n(bytes_of(header).begin(), sizeof header, out.begin());
  rest = std::copy(block.data.begin(), block.data.end(), rest);
  std::fill(rest, out.begin() + static_cast<std::ptrdiff_t>(len), std::byte{0});
  return len;
}

std::optional<Block> parse_block(std::span<const std::byte> bytes) {
  BlockHeader header;
  if (!read_payload(bytes, header) || header.magic != kBlockMagic) return std::nullopt;
  const auto rest = bytes.subspan(sizeof header);
  if (header.data_len > rest.size() || block_len(header.data_len) != bytes.size()) return std::nullopt;
  const auto data = rest.first(header.data_len);
  if (header.crc32c != sum_of(header, data)) return std::nullopt;
  return Block{header.offset, data};
}

}  // namespace sonoloft::protocol
