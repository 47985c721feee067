// libusb's interrupt and bulk OUT endpoints against the firmware.
#include <chrono>
#include <thread>

#include "tests/usb/umockdev/usb_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;

TEST_CASE("usb: buttons of the probe come as events, each once, also after its port was reset") {
  MockBus bus;
  UsbBench bench(1u << 30, "USB-1", 100);
  bench.plug_into(bus);
  auto session = open_usb();
  for (const bool reset : {false, true}) {
    Inbox inbox;
    REQUIRE(session->start({}, inbox.callbacks()));
    if (reset) {
      bench.probe().freeze_until(MockProbe::Cure::reset);
      while (bench.probe().resets() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      REQUIRE(inbox.wait_for_slices(1));
    }
    for (std::uint16_t i = 0; i < 30; ++i) {
      bench.loopback().button(i, i % 2 == 0);
      REQUIRE(inbox.wait_for(EventKind::button, i + 1u));
    }
    session->stop();
    std::uint16_t expected = 0;
    for (const device::Event& event : inbox.events()) {
      if (event.kind != EventKind::button) continue;
      CHECK(event.button->number == expected);
      CHECK(event.button->pressed == (expected % 2 == 0));
      ++expected;
    }
    CHECK(expected == 30);
    CHECK(session->statistics().events_lost == 0);
  }
}

TEST_CASE("usb: a blob goes to the probe and is kept; unplugged, that is said at once") {
  MockBus bus;
  UsbBench bench(1);
  bench.plug_into(bus);
  auto session = open_usb();
  std::vector<std::byte> blob(300'000);
  for (std::size_t i = 0; i < blob.size(); ++i) blob[i] = static_cast<std::byte>(i * 7 + i / 251);
  REQUIRE(session->send_blob(device::BlobKind::firmware, blob));
  bench.probe().unplug();
  const auto sent = session->send_blob(device::BlobKind::firmware, blob);
  REQUIRE_FALSE(sent);
  session.reset();
  CHECK(bench.blobs().kept(device::BlobKind::firmware) == blob);
}
