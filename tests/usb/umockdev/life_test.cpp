// Finding, opening, closing, and plugging in and out.
#include <unistd.h>

#include <condition_variable>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <thread>

#include "host/device/usb/usb_monitor.h"
#include "tests/usb/umockdev/usb_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;

namespace {

std::ptrdiff_t open_files() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

}  // namespace

TEST_CASE("usb: probes are listed with serial number, place, negotiated speed and version") {
  MockBus bus;
  const auto nobody = device::list_usb_devices();
  REQUIRE(nobody);
  CHECK(nobody->empty());
  UsbBench left(1, "LEFT"), right(1, "RIGHT");
  left.plug_into(bus, 1);
  right.plug_into(bus, 4);
  const auto listed = device::list_usb_devices();
  REQUIRE(listed);
  REQUIRE(listed->size() == 2);
  for (const auto& probe : *listed) {
    CHECK(probe.location == (probe.serial == "LEFT" ? "1-1" : "1-4"));
    CHECK(probe.speed_mbit == 480);
    CHECK(probe.version.major == protocol::kVersion.major);
    CHECK(probe.version.minor == protocol::kVersion.minor);
    CHECK_FALSE(probe.problem);
  }
  CHECK((*listed)[0].serial != (*listed)[1].serial);
}

TEST_CASE("usb: the monitor tells of probes that are there, come and go, and opens none") {
  MockBus bus;
  UsbBench first(1, "FIRST"), second(1, "SECOND");
  first.plug_into(bus, 1);
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::string> told;
  const auto monitor = device::UsbMonitor::start([&](const device::UsbPlugEvent& event) {
    const std::lock_guard lock(mutex);
    told.push_back((event.arrived ? "+" : "-") + event.location);
    changed.notify_all();
  });
  REQUIRE(monitor);
  const auto wait_for = [&](std::size_t count) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(60), [&] { return told.size() >= count; });
  };
  REQUIRE(wait_for(1));
  first.probe().forbid();
  second.plug_into(bus, 2);
  REQUIRE(wait_for(2));
  first.probe().unplug();
  REQUIRE(wait_for(3));
  CHECK(told == std::vector<std::string>{"+1-1", "+1-2", "-1-1"});
}

TEST_CASE("usb: a probe that is not there is said not to be there") {
  MockBus bus;
  const auto opened = device::UsbTransport::open("USB-9");
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == ErrorCode::device_not_found);
  CHECK(opened.error().message.find("USB-9") != std::string::npos);
}

TEST_CASE("usb: without permission the error names the udev rule") {
  MockBus bus;
  UsbBench bench(1);
  bench.plug_into(bus);
  const auto before = device::UsbTransport::open();  // libusb knows the device from now on
  REQUIRE(before);
  bench.probe().forbid();
  const uid_t user = geteuid();
  if (user == 0) REQUIRE(seteuid(65534) == 0);
  const auto opened = device::UsbTransport::open();
  const auto listed = device::list_usb_devices();
  if (user == 0) REQUIRE(seteuid(user) == 0);
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == ErrorCode::io_failed);
  CHECK(opened.error().message.find("udev rule") != std::string::npos);
  REQUIRE(listed);
  REQUIRE(listed->size() == 1);
  REQUIRE((*listed)[0].problem);
}

TEST_CASE("usb: a kernel that allows too little memory is found out before it fails") {
  MockBus bus;
  UsbBench bench(10);
  bench.plug_into(bus);
  Inbox inbox;
  auto session = open_usb();
  // Records are up to 70 KB here: with 1 MB there is room for all transfers, but not for records of others.
  bus.write_sys("module/usbcore/parameters/usbfs_memory_mb", "1\n");
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  CHECK(inbox.slices().size() == 10);
}

TEST_CASE("usb: unplugged with transfers in flight, it says so once; plugged in again, the session goes on") {
  MockBus bus;
  UsbBench bench(1u << 30, "USB-1", 500);
  bench.plug_into(bus);
  auto session = open_usb();
  for (int round = 0; round < 5; ++round) {
    Inbox inbox;
    REQUIRE(session->start({}, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(20));
    bench.probe().unplug();
    REQUIRE(inbox.wait_for(EventKind::disconnected));
    const auto early = session->start({}, {});
    CHECK_FALSE(early);
    session->stop();
    CHECK(inbox.count(EventKind::disconnected) == 1);
    CHECK(inbox.events().back().kind == EventKind::disconnected);
    check_rising(inbox.slices());
    check_closed(session->ledger());
    const auto absent = session->start({}, {});
    REQUIRE_FALSE(absent);
    CHECK(absent.error().code == ErrorCode::device_not_found);
    bench.plug_into(bus, 2 + round);
  }
}

TEST_CASE("usb: unplugged between two runs, the next one finds the probe where it is now") {
  MockBus bus;
  UsbBench bench(1u << 30);
  bench.plug_into(bus);
  auto session = open_usb();
  bench.plug_into(bus, 7);
  Inbox inbox;
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(3));
  session->stop();
  check_closed(session->ledger());
}

TEST_CASE("usb: unplugged and stopped at the same moment, at most one word of it") {
  MockBus bus;
  UsbBench bench(1u << 30);
  for (int round = 0; round < 20; ++round) {
    bench.plug_into(bus, 1 + round);
    Inbox inbox;
    auto session = open_usb();
    REQUIRE(session->start({}, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(1 + static_cast<std::size_t>(round)));
    std::jthread puller([&] { bench.probe().unplug(); });
    session->stop();
    CHECK(inbox.count(EventKind::disconnected) <= 1);
  }
}

TEST_CASE("usb: opened and closed 200 times, every run begins with record 0 and no file stays open") {
  MockBus bus;
  UsbBench bench(1u << 30);
  bench.plug_into(bus);
  std::ptrdiff_t before = 0;
  for (int round = 0; round < 200; ++round) {
    Inbox inbox;
    auto session = open_usb();
    REQUIRE(session->start(kLossless, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(2));
    session->stop();
    check_in_order(inbox.slices());
    REQUIRE(session->ledger().closed);
    REQUIRE(session->ledger().transport_lost == 0);
    session.reset();
    if (round == 0) before = open_files();
  }
  // umockdev closes its ends of what we closed a moment later.
  for (int i = 0; i < 1000 && open_files() > before; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(open_files() <= before);
  MESSAGE("open files: " << before);
}
