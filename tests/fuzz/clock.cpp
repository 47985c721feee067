// The clock map: exchanges as a device may make them up, between times to map.
#include <vector>

#include "host/device/clock/clock_map.h"
#include "tests/fuzz/input.h"

using namespace sonoloft;
using device::TimeExchange;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  device::ClockMap map;
  std::int64_t host_ns = 1'000'000'000'000;  // this clock is ours: it runs on, and not far
  std::uint64_t device_ns = input.number<std::uint64_t>();
  for (int step = 0; !input.empty() && step < 200; ++step) {
    if (input.number<std::uint8_t>() % 2 == 0) {
      std::vector<TimeExchange> burst;
      for (int i = input.number<std::uint8_t>() % 4; i >= 0; --i) {
        const std::int64_t sent = host_ns;
        host_ns += input.number<std::uint32_t>();
        burst.push_back({sent, input.number<std::uint64_t>(), host_ns});
      }
      map.add(burst);
    } else {
      device_ns += input.number<std::uint64_t>();
      const auto mapped = map.at(device_ns);
      if (mapped) fuzz::demand(mapped->uncertainty.count() >= 0);
    }
  }
  return 0;
}
