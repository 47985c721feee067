#include "protocol/event.h"

#include <cstring>

#include "protocol/command.h"
#include "protocol/crc32c.h"

namespace sonoloft::protocol {
namespace {

std::uint32_t sum_of(const EventMessage& event) {
  return crc32c(bytes_of(event).first(offsetof(EventMessage, crc32c)));
}

}  // namespace

EventMessage seal_event(EventMessage event) {
  event.magic = kEventMagic;
  event.crc32c = sum_of(event);
  return event;
}

std::optional<EventMessage> parse_event(std::span<const std::byte> bytes) {
  EventMessage event;
  if (!read_payload(bytes, event) || event.magic != kEventMagic || event.crc32c != sum_of(event)) return std::nullopt;
  return event;
}

}  // namespace sonoloft::protocol
