#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

// What a device tells by itself, beside the stream: one event in one transfer. Since 1.1.

namespace sonoloft::protocol {

enum class EventKind : std::uint16_t {
  state = 1,         ///< it left the streaming state by itself; HEARTBEAT says why
  source_ended = 2,  ///< nothing more will be acquired in this session
  button = 3,        ///< a button of the probe; of this number, pressed (1) or let go (0)
};

struct EventMessage {
  std::uint32_t magic;
  std::uint16_t kind;        ///< EventKind; others are a later version's and mean nothing to a reader
  std::uint16_t number;      ///< of a button, from 0
  std::uint32_t value;       ///< of a button
  std::uint32_t session_id;  ///< as given with START
  std::uint64_t t_device_ns;
  std::uint32_t seq;  ///< 0 at START, then one more with every event: a gap is what was lost
  std::uint32_t crc32c;
};
inline constexpr std::uint32_t kEventMagic = 0x56454C53;  ///< "SLEV"
inline constexpr std::size_t kEventLen = sizeof(EventMessage);

static_assert(kEventLen == 32 && offsetof(EventMessage, t_device_ns) == 16 && offsetof(EventMessage, crc32c) == 28);

/// The event with its magic number and its sum.
[[nodiscard]] EventMessage seal_event(EventMessage event);

/// nullopt: no event, or one that was altered. Longer ones are a later version's. Any bytes are legal.
[[nodiscard]] std::optional<EventMessage> parse_event(std::span<const std::byte> bytes);

}  // namespace sonoloft::protocol
