#include "device_sim/firmware/event_queue.h"

#include <algorithm>
#include <cassert>

#include "protocol/command.h"

namespace sonoloft::device_sim {

void EventQueue::begin(std::uint32_t session_id) {
  clear();
  session_id_ = session_id;
  next_seq_ = 0;
}

void EventQueue::push(protocol::EventMessage event) {
  event.session_id = session_id_;
  event.seq = next_seq_++;
  events_[(first_ + used_) % kCapacity] = protocol::seal_event(event);
  if (used_ == kCapacity) {
    first_ = (first_ + 1) % kCapacity;
  } else {
    ++used_;
  }
}

std::size_t EventQueue::take(std::span<std::byte> out) {
  if (empty()) return 0;
  assert(out.size() >= protocol::kEventLen);
  const auto bytes = protocol::bytes_of(events_[first_]);
  std::copy(bytes.begin(), bytes.end(), out.begin());
  first_ = (first_ + 1) % kCapacity;
  --used_;
  return bytes.size();
}

}  // namespace sonoloft::device_sim
