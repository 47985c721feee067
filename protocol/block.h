#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

// How a blob (a firmware image, a calibration) goes to a device: in blocks, one in one transfer, each with its place
// and its sum, so that what is lost on the way can be sent again. BEGIN_BLOB comes before, KEEP_BLOB after. Since 1.1.

namespace sonoloft::protocol {

struct BlockHeader {
  std::uint32_t magic;
  std::uint32_t offset;  ///< of its first byte in the blob
  std::uint32_t data_len;
  std::uint32_t crc32c;  ///< of the 12 bytes before and the data
};
inline constexpr std::uint32_t kBlockMagic = 0x4B424C53;  ///< "SLBK"
/// A block's length beside its data: the header, and zeros where its length would be a multiple of kPacketDivisor.
inline constexpr std::size_t kMaxBlockOverhead = 2 * sizeof(BlockHeader);

static_assert(sizeof(BlockHeader) == 16);

struct Block {
  std::uint32_t offset;
  std::span<const std::byte> data;
};

/// @pre    out.size() >= block.data.size() + kMaxBlockOverhead
/// @return the length written
[[nodiscard]] std::size_t encode_block(const Block& block, std::span<std::byte> out);

/// nullopt: no block, or one that was altered. Any bytes are legal.
[[nodiscard]] std::optional<Block> parse_block(std::span<const std::byte> bytes);

}  // namespace sonoloft::protocol
