// Streams that stand still, and what is done about it.
#include <chrono>
#include <thread>

#include "tests/usb/umockdev/usb_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;

TEST_CASE("usb: an endpoint that stalls is cleared and the stream goes on") {
  MockBus bus;
  UsbBench bench(1u << 30, "USB-1", 500);
  bench.plug_into(bus);
  Inbox inbox;
  auto session = open_usb();
  REQUIRE(session->start({}, inbox.callbacks()));
  for (int round = 0; round < 10; ++round) {
    REQUIRE(inbox.wait_for_slices(inbox.slices().size() + 5));
    const int cleared = bench.probe().clear_halts();
    bench.probe().halt();
    while (bench.probe().clear_halts() == cleared) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  REQUIRE(inbox.wait_for_slices(inbox.slices().size() + 20));
  session->stop();
  CHECK(inbox.events().empty());
  check_closed(session->ledger());
}

TEST_CASE("usb: a stream that stands still is freed by clearing the halt of its endpoint") {
  MockBus bus;
  UsbBench bench(1u << 30, "USB-1", 100);
  bench.plug_into(bus);
  Inbox inbox;
  auto session = open_usb();
  REQUIRE(session->start({}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(10));
  bench.probe().freeze_until(MockProbe::Cure::clear_halt);
  const auto before = inbox.slices().size();
  REQUIRE(inbox.wait_for_slices(before + 30));
  session->stop();
  CHECK(inbox.events().empty());
  check_closed(session->ledger());
}

TEST_CASE("usb: a stream that only a port reset frees is reset, and the run goes on") {
  MockBus bus;
  UsbBench bench(1u << 30, "USB-1", 100);
  bench.plug_into(bus);
  Inbox inbox;
  auto session = open_usb();
  REQUIRE(session->start({}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(10));
  bench.probe().freeze_until(MockProbe::Cure::reset);
  const auto before = inbox.slices().size();
  REQUIRE(inbox.wait_for_slices(before + 30));
  session->stop();
  CHECK(bench.probe().resets() == 1);
  CHECK(inbox.events().empty());
  check_closed(session->ledger());
}

TEST_CASE("usb: a stream that a reset does not free ends the run, and the next start goes on after another one") {
  MockBus bus;
  UsbBench bench(1u << 30, "USB-1", 100);
  bench.plug_into(bus);
  Inbox inbox, second;
  auto session = open_usb();
  REQUIRE(session->start({}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(10));
  bench.probe().freeze_until(MockProbe::Cure::reset, 2);
  REQUIRE(inbox.wait_for(EventKind::disconnected));
  session->stop();
  CHECK(bench.probe().resets() == 1);
  check_closed(session->ledger());
  REQUIRE(session->start({}, second.callbacks()));
  CHECK(bench.probe().resets() == 2);
  REQUIRE(second.wait_for_slices(10));
  session->stop();
  check_rising(second.slices());
  check_closed(session->ledger());
}
