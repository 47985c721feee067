// libusb against the firmware: what a session does over USB as over any other bus.
#include <algorithm>
#include <atomic>
#include <future>
#include <stdexcept>
#include <thread>

#include "tests/usb/umockdev/usb_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;
using device::StreamMode;

TEST_CASE("usb: 1,000 slices arrive in order as they do over the loopback, and the books close") {
  MockBus bus;
  UsbBench bench(1000);
  bench.plug_into(bus);
  Inbox inbox, loopback_inbox;
  auto session = open_usb("USB-1");
  CHECK(session->info().serial == "USB-1");
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  check_closed(session->ledger());
  CHECK(session->ledger().delivered == 1000);
  CHECK(session->ledger().transport_lost == 0);

  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1000));
  auto other = open_session(loopback.port());
  REQUIRE(other->start(kLossless, loopback_inbox.callbacks()));
  REQUIRE(loopback_inbox.wait_for(EventKind::end_of_data));
  other->stop();
  const auto slices = inbox.slices(), expected = loopback_inbox.slices();
  REQUIRE(slices.size() == 1000);
  REQUIRE(expected.size() == 1000);
  check_in_order(slices);
  for (std::size_t i = 0; i < 1000; ++i) {
    REQUIRE(slices[i]->slice.points == expected[i]->slice.points);
    REQUIRE(slices[i]->slice.image_to_reference.isApprox(expected[i]->slice.image_to_reference, 0));
    REQUIRE(slices[i]->slice.time == expected[i]->slice.time);
  }
}

TEST_CASE("usb: stop inside a callback returns at once and no callback follows") {
  MockBus bus;
  UsbBench bench(1u << 30);
  bench.plug_into(bus);
  auto session = open_usb();
  for (const std::uint64_t last : {0u, 1u, 37u}) {
    std::atomic<std::uint64_t> calls = 0;
    std::promise<void> stopped;
    REQUIRE(session->start(kLossless, {[&](auto) {
                                         if (++calls != last + 1) return;
                                         session->stop();
                                         stopped.set_value();
                                       },
                                       {}}));
    stopped.get_future().wait();
    session->stop();
    CHECK(calls == last + 1);
    check_closed(session->ledger());
  }
}

TEST_CASE("usb: a callback that throws becomes an event and the stream goes on") {
  MockBus bus;
  UsbBench bench(50);
  bench.plug_into(bus);
  Inbox inbox;
  auto session = open_usb();
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](auto slice) {
    const auto id = slice->slice.id;
    inbox.add(std::move(slice));
    if (id % 10 == 3) throw std::runtime_error("slice " + std::to_string(id));
  };
  REQUIRE(session->start(kLossless, callbacks));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  CHECK(inbox.slices().size() == 50);
  CHECK(inbox.count(EventKind::callback_threw) == 5);
  check_closed(session->ledger());
}

TEST_CASE("usb: a callback slower than the stream costs slices, which are counted, and never the link") {
  MockBus bus;
  UsbBench bench(1u << 30);
  bench.plug_into(bus);
  Inbox inbox;
  auto session = open_usb();
  std::promise<void> release;
  auto gate = release.get_future().share();
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](auto slice) {
    inbox.add(std::move(slice));
    gate.wait();
  };
  REQUIRE(session->start({StreamMode::live, 8}, callbacks));
  REQUIRE(inbox.wait_for_slices(1));
  while (session->ledger().host_dropped < 200) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(inbox.slices().size() == 1);
  release.set_value();
  REQUIRE(inbox.wait_for(EventKind::slices_dropped));
  session->stop();
  check_closed(session->ledger());
}

TEST_CASE("usb: in lossless mode a callback that sleeps past the device's watchdog holds the stream, not the link") {
  MockBus bus;
  UsbBench bench(60);
  bench.plug_into(bus);
  Inbox inbox;
  auto session = open_usb();
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](auto slice) {
    if (slice->slice.id == 5) std::this_thread::sleep_for(std::chrono::milliseconds(2000));
    inbox.add(std::move(slice));
  };
  REQUIRE(session->start({StreamMode::lossless, 2}, callbacks));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  CHECK(inbox.slices().size() == 60);
  CHECK(inbox.events().size() == 1);
  check_closed(session->ledger());
}

TEST_CASE("usb: two probes at once stream side by side, each by its serial number") {
  MockBus bus;
  UsbBench left(300, "LEFT"), right(300, "RIGHT");
  left.plug_into(bus, 1);
  right.plug_into(bus, 2);
  const auto none = device::UsbTransport::open();
  REQUIRE_FALSE(none);
  CHECK(none.error().code == ErrorCode::device_not_found);
  Inbox of_left, of_right;
  auto left_session = open_usb("LEFT"), right_session = open_usb("RIGHT");
  REQUIRE(left_session->start(kLossless, of_left.callbacks()));
  REQUIRE(right_session->start(kLossless, of_right.callbacks()));
  REQUIRE(of_left.wait_for(EventKind::end_of_data));
  REQUIRE(of_right.wait_for(EventKind::end_of_data));
  left_session->stop();
  right_session->stop();
  CHECK(of_left.slices().size() == 300);
  CHECK(of_right.slices().size() == 300);
  check_closed(left_session->ledger());
  check_closed(right_session->ledger());
}
