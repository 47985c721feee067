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
volatile std::uint32_t request_len, reply_len, record_len, event_len, block_len, buttons, bus_is_free;
volatile std::uint64_t clock_ns;
volatile std::uint8_t flash;
std::array<std::byte, device_sim::BlobReceiver::kMaxBlock> block;
std::array<std::byte, protocol::kEventLen> event;
std::array<std::byte, protocol::kMaxRequestLen> request, reply;
device_sim::AcquiredSlice acquired;

class Flash final : public device_sim::BlobStore {
 public:
  [[nodiscard]] std::uint32_t max_blob() const override { return 1u << 20; }
  [[nodiscard]] bool begin(protocol::BlobKind, std::uint32_t) override { return flash == 0; }
  [[nodiscard]] bool write(std::span<const std::byte> bytes) override {
    for (const std::byte b : bytes) flash = std::to_integer<std::uint8_t>(b);
    return true;
  }
  [[nodiscard]] Kept keep() override { return Kept::yes; }
};

constexpr protocol::SliceLimits kLimits{4096, 128, 255, 8192, 1u << 20};
constexpr std::size_t kSlotLen = 67'328;  // record_slot_len(kLimits); main() looks
constexpr std::size_t kRecords = 4;

// One slot more than records wait: that of the record which is on the bus.
alignas(protocol::kRecordAlign) std::array<std::byte, (kRecords + 1) * kSlotLen> ring_memory;

}  // namespace

int main() {
  if (device_sim::record_slot_len(kLimits) > kSlotLen) return 1;
  device_sim::FirmwareConfig config;
  static Flash blobs;
  config.limits = kLimits;
  config.blobs = &blobs;
  const auto memory = std::span(ring_memory);
  static device_sim::Firmware firmware(config, memory.first<kRecords * kSlotLen>());
  while (true) {
    const std::uint64_t now = clock_ns;
    if (request_len != 0) reply_len = firmware.handle_request(std::span(request).first(request_len), reply, now);
    firmware.acquire(acquired, now);
    firmware.tick(now);
    if (buttons != 0) firmware.button(0, buttons == 1, now);
    if (block_len != 0) firmware.take_block(std::span(block).first(block_len));
    if (bus_is_free != 0) record_len = firmware.take_record(memory.last<kSlotLen>());
    if (bus_is_free != 0) event_len = firmware.take_event(event);
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
