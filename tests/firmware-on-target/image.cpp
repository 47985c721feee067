// What a board would be flashed with, but for its drivers: their place is taken by volatile words, so that everything
// of the firmware is reachable and its size is told as it is.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "device_sim/firmware/firmware.h"
#include "protocol/command.h"
#include "protocol/record.h"

namespace {

using namespace sonoloft;

// What drivers would fill and empty.
volatile std::uint32_t request_len, reply_len, record_len, bus_is_free;
volatile std::uint64_t clock_ns;
std::array<std::byte, protocol::kMaxRequestLen> request, reply;
device_sim::AcquiredSlice acquired;

constexpr protocol::SliceLimits kLimits{4096, 128, 255};
constexpr std::size_t kSlotLen = 67'328;  // record_slot_len(kLimits); main() looks
constexpr std::size_t kRecords = 4;

// One slot more than records wait: that of the record which is on the bus.
alignas(protocol::kRecordAlign) std::array<std::byte, (kRecords + 1) * kSlotLen> ring_memory;

}  // namespace

int main() {
  if (device_sim::record_slot_len(kLimits) > kSlotLen) return 1;
  device_sim::FirmwareConfig config;
  config.limits = kLimits;
  const auto memory = std::span(ring_memory);
  static device_sim::Firmware firmware(config, memory.first<kRecords * kSlotLen>());
  while (true) {
    const std::uint64_t now = clock_ns;
    if (request_len != 0) reply_len = firmware.handle_request(std::span(request).first(request_len), reply, now);
    firmware.acquire(acquired, now);
    firmware.tick(now);
    if (bus_is_free != 0) record_len = firmware.take_record(memory.last<kSlotLen>());
  }
}

extern "C" {
void before_main() {}
[[noreturn]] void after_main(int) {
  while (true) {
  }
}
// The C library's own tells signal handlers, which it keeps on a heap.
[[noreturn]] void abort() {
  while (true) {
  }
}
}

// Destructors that are virtual name it, though nothing is ever deleted.
void operator delete(void*) noexcept {
  abort();
}
void operator delete(void*, std::size_t) noexcept {
  abort();
}
