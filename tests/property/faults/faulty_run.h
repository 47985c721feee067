#pragma once
#include <cstdint>
#include <string>

#include "device_sim/port/fault/fault_plan.h"
#include "host/device/ledger.h"
#include "tests/property/faults/bus.h"

namespace sonoloft::test {

struct FaultyRun {
  device::Ledger ledger;
  std::uint64_t faults = 0;
  double slowest_call_ms = 0;  ///< start() or stop()
  std::string complaint;       ///< the first thing that was not as it must be; empty: none
};

/// Streams `records` slices over a bus with faults, lossless, after a short session without any.
[[nodiscard]] FaultyRun faulty_run(const Bus& bus, device_sim::FaultKind kind, std::uint32_t seed,
                                   std::uint32_t records);

}  // namespace sonoloft::test
