#include <doctest/doctest.h>

#include <array>

#include "device_sim/port/fault/faulty_port.h"
#include "tests/support/wire/loopback_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;
using device::StreamMode;
using device_sim::FaultKind;

TEST_CASE("ledger: live, with a small ring, a slow callback and a bad cable, it still closes") {
  constexpr std::array kKinds{FaultKind::drop, FaultKind::flip, FaultKind::truncate, FaultKind::duplicate};
  std::uint64_t device_dropped = 0, host_dropped = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    const bool to_the_end = seed % 2 == 1;  // the others are stopped in the middle, records under way everywhere
    device_sim::LoopbackDevice loopback(loopback_options(2), numbered_slices(to_the_end ? 1500 : 1u << 30));
    device_sim::FaultyPort port(loopback.port());
    port.set_plan({kKinds[seed / 2 % kKinds.size()], seed, 10});
    Inbox inbox;
    auto session = open_session(port);
    auto callbacks = inbox.callbacks();
    callbacks.on_slice = [&](auto slice) {
      if (slice->slice.id % 3 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      inbox.add(std::move(slice));
    };
    REQUIRE(session->start({StreamMode::live, 2}, callbacks));
    REQUIRE((to_the_end ? inbox.wait_for(EventKind::end_of_data) : inbox.wait_for_slices(20)));
    session->stop();
    const device::Ledger ledger = session->ledger();
    check_closed(ledger);
    CHECK(ledger.transport_lost == port.counts().lost);
    CHECK(ledger.crc_bad + ledger.malformed == port.counts().altered);
    CHECK(ledger.delivered == inbox.slices().size());
    if (to_the_end) CHECK(ledger.made == 1500);
    device_dropped += ledger.device_dropped;
    host_dropped += ledger.host_dropped;
  }
  MESSAGE(device_dropped << " dropped by the device, " << host_dropped << " by the host");
  CHECK(host_dropped > 0);
}
