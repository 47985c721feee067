// The firmware: any requests and blocks, in any order, between acquisitions, buttons, sent records and events.
#include <array>

#include "device_sim/firmware/firmware.h"
#include "device_sim/simulator/memory_blobs.h"
#include "protocol/block.h"
#include "protocol/event.h"
#include "protocol/record.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;
using namespace sonoloft::protocol;

namespace {

constexpr SliceLimits kLimits{16, 4, 9, 8, 64};
alignas(kRecordAlign) std::array<std::byte, 4096> memory, record;
std::array<std::byte, kMaxRequestLen> reply;

constexpr std::array<Point, 4> kPoints{{{1, 1}, {5, 1}, {5, 5}, {1, 5}}};

void acquire(device_sim::Firmware& firmware, fuzz::Input& input, std::uint64_t now_ns) {
  const Contour contour{0, input.number<std::uint8_t>() % 6u, input.number<std::uint16_t>(), 0};
  Slice slice;
  slice.points = std::span(kPoints).first(input.number<std::uint8_t>() % 5u);
  slice.contours = {&contour, 1};
  firmware.acquire(slice, now_ns);
}

void acquire_mask(device_sim::Firmware& firmware, fuzz::Input& input, std::uint64_t now_ns) {
  std::array<MaskRun, 3> runs{};
  for (MaskRun& run : runs) run = {input.number<std::uint8_t>(), input.number<std::uint16_t>()};
  Slice slice;
  slice.mask_grid = {0, 0, 1, input.number<std::uint8_t>(), input.number<std::uint8_t>()};
  slice.mask_runs = std::span(runs).first(1 + input.number<std::uint8_t>() % 3u);
  firmware.acquire(slice, now_ns);
}

// A block that is one, of the blob's bytes 0, 1, 2, ... so that some are complete.
void send_block(device_sim::Firmware& firmware, fuzz::Input& input) {
  std::array<std::byte, 256> data, block;
  const std::uint32_t offset = input.number<std::uint16_t>();
  const std::size_t len = input.number<std::uint8_t>() % 200u;
  for (std::size_t i = 0; i < len; ++i) data[i] = static_cast<std::byte>(offset + i);
  firmware.take_block(std::span(block).first(encode_block({offset, std::span(data).first(len)}, block)));
}

void take_event(device_sim::Firmware& firmware) {
  std::array<std::byte, kEventLen> event;
  const std::size_t len = firmware.take_event(event);
  fuzz::demand(len == 0 || parse_event(event).has_value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  device_sim::FirmwareConfig config;
  device_sim::MemoryBlobs blobs;
  config.limits = kLimits;
  config.blobs = &blobs;
  device_sim::Firmware firmware(config, memory);
  std::uint64_t now_ns = 0;
  while (!input.empty()) {
    const auto what = input.number<std::uint8_t>();
    now_ns += (what >> 4) * 100'000'000ull;
    switch (what % 9) {
      case 0:
        acquire(firmware, input, now_ns);
        break;
      case 1:
        fuzz::demand(firmware.take_record(record) <= firmware.max_record());
        break;
      case 2:
        firmware.tick(now_ns);
        break;
      case 4:
        acquire_mask(firmware, input, now_ns);
        break;
      case 5:
        firmware.button(input.number<std::uint8_t>(), (what & 16) != 0, now_ns);
        break;
      case 6:
        take_event(firmware);
        break;
      case 7:
        send_block(firmware, input);
        break;
      case 8:
        firmware.take_block(input.take(input.number<std::uint8_t>()));
        break;
      default: {
        const auto request = input.take(input.number<std::uint16_t>() % (kMaxRequestLen + 8));
        const std::size_t len = firmware.handle_request(request, reply, now_ns);
        fuzz::demand(parse_reply(std::span<const std::byte>(reply).first(len)).has_value());
      }
    }
    const StatsReply stats = firmware.stats();
    fuzz::demand(stats.next_seq == stats.sent + stats.dropped + stats.ring_used);
  }
  return 0;
}
