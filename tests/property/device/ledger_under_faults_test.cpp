#include <doctest/doctest.h>

#include "tests/support/faulty_port.h"
#include "tests/support/loopback_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;
using device::StreamMode;

TEST_CASE("ledger: over a bad cable every record is accounted for, each kind exactly as often as it was done") {
  device::Ledger total;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    device_sim::LoopbackDevice loopback(loopback_options(1 + seed % 5), numbered_slices(300));
    FaultyPort port(loopback.port(), seed, 2 + seed);
    Inbox inbox;
    auto session = open_session(port);
    REQUIRE(session->start({StreamMode::lossless, 4}, inbox.callbacks()));
    REQUIRE(inbox.wait_for(EventKind::end_of_data));
    session->stop();
    const device::Ledger ledger = session->ledger();
    check_closed(ledger);
    CHECK(ledger.made == 300);
    CHECK(ledger.transport_lost == port.lost);
    CHECK(ledger.crc_bad == port.altered);
    CHECK(ledger.malformed == port.cut);
    CHECK(ledger.foreign == port.repeated);
    CHECK(ledger.delivered == 300 - port.lost - port.altered - port.cut);
    CHECK(ledger.device_dropped == 0);
    CHECK(ledger.delivered == inbox.slices().size());
    // What arrived arrived unaltered and in order.
    std::uint64_t last = 0;
    for (const auto& delivered : inbox.slices()) {
      const auto id = static_cast<std::uint32_t>(delivered->slice.id);
      REQUIRE((id == 0 || id > last));
      last = id;
      REQUIRE(delivered->slice.time.count() == static_cast<long>(make_wire_slice(id).slice.time_ns));
    }
    total.transport_lost += ledger.transport_lost;
    total.crc_bad += ledger.crc_bad;
    total.malformed += ledger.malformed;
    total.foreign += ledger.foreign;
  }
  MESSAGE("of 3600 records " << total.transport_lost << " lost, " << total.crc_bad << " altered, " << total.malformed
                             << " cut, " << total.foreign << " repeated");
  CHECK(total.transport_lost > 20);
  CHECK(total.crc_bad > 20);
  CHECK(total.malformed > 20);
  CHECK(total.foreign > 20);
}

TEST_CASE("ledger: live, with a small ring, a slow callback and a bad cable, it still closes") {
  std::uint64_t device_dropped = 0, host_dropped = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    const bool to_the_end = seed % 2 == 1;  // the others are stopped in the middle, records under way everywhere
    device_sim::LoopbackDevice loopback(loopback_options(2), numbered_slices(to_the_end ? 1500 : 1u << 30));
    FaultyPort port(loopback.port(), seed, 10);
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
    CHECK(ledger.transport_lost == port.lost);
    CHECK(ledger.crc_bad == port.altered);
    CHECK(ledger.malformed == port.cut);
    CHECK(ledger.delivered == inbox.slices().size());
    if (to_the_end) CHECK(ledger.made == 1500);
    device_dropped += ledger.device_dropped;
    host_dropped += ledger.host_dropped;
  }
  MESSAGE(device_dropped << " dropped by the device, " << host_dropped << " by the host");
  CHECK(host_dropped > 0);
}
