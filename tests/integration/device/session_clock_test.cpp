#include <doctest/doctest.h>

#include "tests/support/wire/loopback_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;

namespace {

std::chrono::nanoseconds steady_now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

/// Slices that are acquired the moment they are asked for.
device_sim::SliceSource slices_of_now(std::uint32_t count) {
  auto current = std::make_shared<OwnedWireSlice>();
  return [current, count, next = std::uint32_t{0}]() mutable -> const device_sim::AcquiredSlice* {
    if (next == count) return nullptr;
    *current = make_wire_slice(next++);
    current->slice.time_ns = static_cast<std::uint64_t>(steady_now().count());
    return &current->view();
  };
}

}  // namespace

TEST_CASE("session: from the first slice on, the device's time is told in the host's, as sure as it says") {
  auto options = loopback_options();
  options.rate_hz = 100;
  device_sim::LoopbackDevice loopback(options, slices_of_now(50));
  auto session = open_session(loopback.port());
  Inbox inbox;
  REQUIRE(session->start({}, inbox.callbacks()));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  const auto slices = inbox.slices();
  REQUIRE(slices.size() > 0);
  std::chrono::nanoseconds largest{0};
  auto last = std::chrono::steady_clock::time_point::min();
  for (const auto& slice : slices) {
    REQUIRE(slice->host_time);
    // The loopback's device runs on the host's clock, so the truth is at hand.
    const auto truth = std::chrono::steady_clock::time_point(slice->slice.time);
    CHECK(std::chrono::abs(slice->host_time->time - truth) <= slice->host_time->uncertainty);
    CHECK(slice->host_time->time > last);
    CHECK(truth <= slice->arrival);
    last = slice->host_time->time;
    largest = std::max(largest, std::chrono::abs(slice->host_time->time - truth));
  }
  const auto statistics = session->statistics();
  REQUIRE(statistics.clock);
  CHECK(statistics.clock->round_trip > std::chrono::nanoseconds(0));
  CHECK(statistics.ledger.closed);
  MESSAGE("largest error " << largest.count() << " ns, round trip " << statistics.clock->round_trip.count() << " ns");
}
