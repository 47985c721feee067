#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "device_sim/port/usb/urb.h"

namespace sonoloft::device_sim::usb {

inline constexpr std::uint8_t kStreamIn = 0x81;  ///< bulk: records
inline constexpr std::uint8_t kEventIn = 0x82;   ///< interrupt: events
inline constexpr std::uint8_t kBlobOut = 0x01;   ///< bulk: blocks of blobs
inline constexpr std::size_t kHighSpeedPacket = 512;
inline constexpr std::size_t kEventPacket = 64;  ///< at any speed
inline constexpr std::uint8_t kConfiguration = 1;
inline constexpr std::uint8_t kMsOsRequest = 0x20;  ///< vendor request that reads the Microsoft OS 2.0 descriptors

/// What the device says of itself: device, configuration, device qualifier and other speed (it can do full speed too),
/// BOS with the platform capabilities of WebUSB and Microsoft OS 2.0, and strings. With the latter Windows loads WinUSB
/// by itself. USB 2.0 and 3.2 chapter 9; WebUSB 1.0; Microsoft OS 2.0 descriptors specification. Immutable.
class Descriptors {
 public:
  /// @pre 1 <= serial.size() <= 126, printable ASCII
  explicit Descriptors(std::string_view serial);

  /// The answer to GET_DESCRIPTOR of this wValue; nullopt: there is none.
  [[nodiscard]] std::optional<std::span<const std::byte>> find(std::uint16_t value) const;
  [[nodiscard]] std::span<const std::byte> microsoft() const { return microsoft_; }

 private:
  struct Entry {
    std::uint16_t value;  ///< type << 8 | index
    std::vector<std::byte> bytes;
  };

  std::vector<std::byte> microsoft_;
  std::vector<Entry> entries_;
};

}  // namespace sonoloft::device_sim::usb
