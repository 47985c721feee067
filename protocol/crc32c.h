#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonoloft::protocol {

/// CRC-32C (Castagnoli, reflected polynomial 0x82F63B78, initial and final xor all ones) as in RFC 3720, appendix B.4.
/// `crc` continues a sum: crc32c(b, crc32c(a)) == crc32c(a followed by b).
/// @cost eight bytes a step, 8 KiB of constant tables (Kounavis, Berry 2005: slicing by 8)
[[nodiscard]] std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t crc = 0);

}  // namespace sonoloft::protocol
