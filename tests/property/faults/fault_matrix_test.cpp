#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
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
constexpr std::size_t kAtATime = 10;  // most of them wait for something

struct Row {
  const Bus& bus;
  FaultKind kind;
  std::array<FaultyRun, kSeeds> runs = {};
};

std::vector<Row> run_all() {
  std::vector<Row> rows;
  for (const Bus& bus : kBuses) {
    for (std::size_t kind = 0; kind < device_sim::kFaultKindCount; ++kind)
      rows.push_back({bus, static_cast<FaultKind>(kind)});
  }
  std::atomic<std::uint32_t> next = 0;
  const auto work = [&] {
    for (std::uint32_t i = next++; i < rows.size() * kSeeds; i = next++) {
      Row& row = rows[i / kSeeds];
      row.runs[i % kSeeds] = faulty_run(row.bus, row.kind, i % kSeeds + 1, kRecords);
    }
  };
  std::vector<std::future<void>> workers;
  for (std::size_t i = 0; i < kAtATime; ++i) workers.push_back(std::async(std::launch::async, work));
  for (auto& worker : workers) worker.get();
  return rows;
}

void print_head() {
  std::printf("%-8s %-18s %6s %8s %9s %7s %7s %9s %6s %7s %7s %9s\n", "bus", "fault", "faults", "made", "delivered",
              "host", "crc", "malformed", "lost", "device", "foreign", "call ms");
}

void print(const Row& row) {
  device::Ledger sum;
  std::uint64_t faults = 0;
  double slowest = 0;
  for (const FaultyRun& run : row.runs) {
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
  std::printf("%-8s %-18s %6lu %8lu %9lu %7lu %7lu %9lu %6lu %7lu %7lu %9.1f\n", row.bus.name,
              device_sim::name(row.kind), faults, sum.made, sum.delivered, sum.host_dropped, sum.crc_bad, sum.malformed,
              sum.transport_lost, sum.device_dropped, sum.foreign, slowest);
}

}  // namespace

TEST_CASE(
    "faults: whatever the cable does, every record is accounted for and every delivered slice is as it was sent") {
  print_head();
  for (const Row& row : run_all()) {
    for (std::size_t i = 0; i < kSeeds; ++i) {
      CHECK_MESSAGE(row.runs[i].complaint.empty(), std::string(row.bus.name), ", ",
                    std::string(device_sim::name(row.kind)), ", seed ", i + 1, ": ", row.runs[i].complaint);
    }
    print(row);
  }
}
