#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

// The words that the device model and the ways to a host's USB stack share.

namespace sonoloft::device_sim::usb {

/// The eight bytes that begin a control transfer, USB 2.0 table 9-2.
struct SetupPacket {
  std::uint8_t request_type, request;
  std::uint16_t value, index, length;

  [[nodiscard]] bool to_host() const { return (request_type & 0x80) != 0; }
};
static_assert(sizeof(SetupPacket) == 8);

/// A transfer that a host asks for.
struct Urb {
  std::uint64_t id = 0;              ///< unique among those that wait
  std::uint8_t endpoint = 0;         ///< address: 0 control, bit 7: to the host
  SetupPacket setup{};               ///< control only
  std::vector<std::byte> data = {};  ///< what the host sends
  std::size_t room = 0;              ///< bytes that the host takes
};

enum class UrbStatus : std::uint8_t {
  ok,
  stalled,
  overflow,  ///< a packet did not fit into what was left of the room
  gone,      ///< the device was unplugged
};

/// How a transfer ended. `data` is what the host gets, valid during the call; `size` the bytes moved either way.
struct UrbDone {
  std::uint64_t id;
  UrbStatus status;
  std::span<const std::byte> data;
  std::size_t size;
};

/// Called once for every URB that was not unlinked, from threads of the device model with locks of it held: it returns
/// at once and calls nothing of the model.
using UrbSink = std::function<void(const UrbDone&)>;

}  // namespace sonoloft::device_sim::usb
