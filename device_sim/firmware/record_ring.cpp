#include "device_sim/firmware/record_ring.h"

#include <algorithm>
#include <cassert>

#include "protocol/record.h"

namespace sonoloft::device_sim {

RecordRing::RecordRing(std::span<std::byte> memory, std::size_t slot_len)
    : memory_(memory),
      slot_len_(slot_len),
      capacity_(static_cast<std::uint16_t>(std::min<std::size_t>(memory.size() / slot_len, 0xFFFF))) {
  assert(reinterpret_cast<std::uintptr_t>(memory.data()) % protocol::kRecordAlign == 0);
  assert(slot_len % protocol::kRecordAlign == 0 && capacity_ >= 1);
}

std::span<std::byte> RecordRing::free_slot() {
  assert(!full());
  return slot((std::size_t{first_} + used_) % capacity_);
}

void RecordRing::push() {
  assert(!full());
  ++used_;
}

std::span<std::byte> RecordRing::oldest() {
  assert(!empty());
  return slot(first_);
}

void RecordRing::pop() {
  assert(!empty());
  first_ = static_cast<std::uint16_t>((first_ + 1) % capacity_);
  --used_;
}

void RecordRing::clear() {
  first_ = 0;
  used_ = 0;
}

}  // namespace sonoloft::device_sim
