#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <future>
#include <string>
#include <vector>

#include "tests/property/faults/faulty_run.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device_sim::FaultKind;

namespace {

constexpr std::uint32_t kRecords = 2000, kSeeds = 5;

void print_head() {
  std::printf("%-18s %6s %8s %9s %7s %7s %9s %6s %7s %7s %9s\n", "fault", "faults", "made", "delivered", "host", "crc",
              "malformed", "lost", "device", "foreign", "call ms");
}

void print(FaultKind kind, const std::vector<FaultyRun>& runs) {
  device::Ledger sum;
  std::uint64_t faults = 0;
  double slowest = 0;
  for (const FaultyRun& run : runs) {
    const device::Ledger& l = run.ledger;
    sum = {sum.made + l.made,
           sum.delivered + l.delivered,
           sum.host_dropped + l.host_dropped,
           sum.crc_bad + l.crc_bad,
           sum.malformed + l.malformed,
           sum.transport_lost + l.transport_lost,
           sum.device_dropped + l.device_dropped,
           sum.foreign + l.foreign};
    faults += run.faults;
    slowest = std::max(slowest, run.slowest_call_ms);
  }
  std::printf("%-18s %6lu %8lu %9lu %7lu %7lu %9lu %6lu %7lu %7lu %9.1f\n", device_sim::name(kind), faults, sum.made,
              sum.delivered, sum.host_dropped, sum.crc_bad, sum.malformed, sum.transport_lost, sum.device_dropped,
              sum.foreign, slowest);
  std::fflush(stdout);
}

}  // namespace

TEST_CASE(
    "faults: whatever the cable does, every record is accounted for and every delivered slice is as it was sent") {
  print_head();
  for (std::size_t k = 0; k < device_sim::kFaultKindCount; ++k) {
    const auto kind = static_cast<FaultKind>(k);
    std::vector<std::future<FaultyRun>> pending;
    for (std::uint32_t seed = 1; seed <= kSeeds; ++seed)
      pending.push_back(std::async(std::launch::async, faulty_run, kind, seed, kRecords));
    std::vector<FaultyRun> runs;
    for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
      runs.push_back(pending[seed - 1].get());
      CHECK_MESSAGE(runs.back().complaint.empty(), std::string(device_sim::name(kind)), ", seed ", seed, ": ",
                    runs.back().complaint);
    }
    print(kind, runs);
  }
}
