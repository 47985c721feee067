#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

// What a writer and a reader of MCAP files share. Format: mcap.dev/spec, version 0.
//   <magic><header>{<schema>}{<channel>}{<chunk>{<message index>}|<metadata>}<data end><summary><footer><magic>
// where each record is  u8 opcode, u64 length, content;  little-endian throughout.

namespace sonoloft::record::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

inline constexpr std::size_t kRecordHeadLen = 9;    ///< opcode and length
inline constexpr std::size_t kMessageHeadLen = 22;  ///< of a message's content: channel, sequence, two times
inline constexpr std::size_t kFooterLen = 20;
/// Of one record: what a reader takes into memory on a file's word.
inline constexpr std::uint64_t kMaxRecordLen = 256u << 20;

/// CRC-32 of zlib, 0 at the beginning; `crc` continues a sum.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes, std::uint32_t crc = 0);

inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

}  // namespace sonoloft::record::mcap
