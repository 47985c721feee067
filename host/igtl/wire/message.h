#pragma once
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

// scene -> [MESSAGE] -> bytes for a client

namespace sonoloft::igtl {

using Bytes = std::vector<std::byte>;

inline constexpr std::size_t kHeaderLen = 58;
inline constexpr std::size_t kNameLen = 20;  ///< of a device, at most

/// One message, without the header that a client's version asks for.
struct Message {
  std::string type;    ///< at most 12 bytes
  std::string device;  ///< at most kNameLen bytes
  std::chrono::system_clock::time_point time;
  Bytes body;
};

/// The message as it is sent. Version 1 is what every reader takes; from version 2 on the body lies between an extended
/// header and metadata, of which there are none here.
/// @cost two passes over the body
/// Source: OpenIGTLink protocol, version 3, "Message structure"; openigtlink.org/developers/spec
[[nodiscard]] Bytes framed(const Message& message, int version);

/// The check sum of bytes that follow those whose check sum is `before`.
[[nodiscard]] std::uint64_t crc(const std::byte* bytes, std::size_t size, std::uint64_t before = 0);

}  // namespace sonoloft::igtl
