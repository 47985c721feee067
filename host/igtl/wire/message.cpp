#include "host/igtl/wire/message.h"

#include <igtl_header.h>
#include <igtl_util.h>

#include <cassert>
#include <cstring>

namespace sonoloft::igtl {
namespace {

static_assert(kHeaderLen == IGTL_HEADER_SIZE && kHeaderLen == sizeof(igtl_header));
static_assert(kNameLen == IGTL_HEADER_NAME_SIZE);

/// Of version 2, big endian: 12 bytes, of which 2 say that the head of the metadata is 2 bytes long; no metadata; id 0.
constexpr std::byte kExtended[] = {
    std::byte{0}, std::byte{12}, std::byte{0}, std::byte{2}, std::byte{0}, std::byte{0},
    std::byte{0}, std::byte{0},  std::byte{0}, std::byte{0}, std::byte{0}, std::byte{0},
};
constexpr std::byte kNoMetadata[] = {std::byte{0}, std::byte{0}};  // how many follow

/// Seconds since 1970 and a binary fraction, 32 bits each.
std::uint64_t timestamp(std::chrono::system_clock::time_point time) {
  const auto since = std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since);
  const auto rest_ns = static_cast<std::uint32_t>((since - seconds).count());
  return static_cast<std::uint64_t>(seconds.count()) << 32 | igtl_nanosec_to_frac(rest_ns);
}

}  // namespace

std::uint64_t crc(const std::byte* bytes, std::size_t size, std::uint64_t before) {
  auto* const data = const_cast<unsigned char*>(reinterpret_cast<const unsigned char*>(bytes));  // it only reads
  return crc64(data, size, before);
}

Bytes framed(const Message& message, int version) {
  assert(message.type.size() <= IGTL_HEADER_TYPE_SIZE && message.device.size() <= kNameLen);
  Bytes bytes(kHeaderLen);
  bytes.reserve(kHeaderLen + sizeof kExtended + message.body.size() + sizeof kNoMetadata);
  if (version >= 2) bytes.insert(bytes.end(), std::begin(kExtended), std::end(kExtended));
  bytes.insert(bytes.end(), message.body.begin(), message.body.end());
  if (version >= 2) bytes.insert(bytes.end(), std::begin(kNoMetadata), std::end(kNoMetadata));

  igtl_header header{};
  header.version = static_cast<igtl_uint16>(version >= 2 ? 2 : 1);
  std::memcpy(header.name, message.type.data(), message.type.size());
  std::memcpy(header.device_name, message.device.data(), message.device.size());
  header.timestamp = timestamp(message.time);
  header.body_size = bytes.size() - kHeaderLen;
  header.crc = crc(bytes.data() + kHeaderLen, bytes.size() - kHeaderLen);
  igtl_header_convert_byte_order(&header);
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

}  // namespace sonoloft::igtl
