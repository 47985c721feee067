// The firmware: any requests, in any order, between acquisitions and sent records.
#include <array>

#include "device_sim/firmware/firmware.h"
#include "protocol/record.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;
using namespace sonoloft::protocol;

namespace {

constexpr SliceLimits kLimits{16, 4, 9};
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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  device_sim::FirmwareConfig config;
  config.limits = kLimits;
  device_sim::Firmware firmware(config, memory);
  std::uint64_t now_ns = 0;
  while (!input.empty()) {
    const auto what = input.number<std::uint8_t>();
    now_ns += (what >> 4) * 100'000'000ull;
    switch (what % 4) {
      case 0:
        acquire(firmware, input, now_ns);
        break;
      case 1:
        fuzz::demand(firmware.take_record(record) <= firmware.max_record());
        break;
      case 2:
        firmware.tick(now_ns);
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
