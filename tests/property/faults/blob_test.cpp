// A blob on its way over a bad cable.
#include <doctest/doctest.h>

#include <random>

#include "device_sim/port/fault/faulty_port.h"
#include "device_sim/simulator/memory_blobs.h"
#include "tests/property/faults/bus.h"
#include "tests/support/wire/loopback_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::BlobKind;
using device_sim::FaultKind;
using device_sim::FaultPlan;
using device_sim::FaultyPort;

namespace {

std::vector<std::byte> some_blob(std::size_t len) {
  std::mt19937 random(3);
  std::vector<std::byte> bytes(len);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

struct Device {
  device_sim::MemoryBlobs store;
  device_sim::LoopbackDevice loopback{options(), numbered_slices(3)};
  FaultyPort port{loopback.port()};

  device_sim::LoopbackOptions options() {
    auto options = loopback_options();
    options.firmware.blobs = &store;
    return options;
  }
};

}  // namespace

TEST_CASE("faults: a blob arrives whole, whatever happens to its blocks") {
  const auto blob = some_blob(400'000);
  for (const Bus& bus : kBuses) {
    for (const FaultKind kind :
         {FaultKind::none, FaultKind::drop, FaultKind::duplicate, FaultKind::truncate, FaultKind::flip}) {
      CAPTURE(std::string(bus.name));
      CAPTURE(std::string(name(kind)));
      Device device;
      auto session = open_session(bus, device.port);
      device.port.set_plan(FaultPlan(kind, 7, 10));
      const auto sent = session->send_blob(BlobKind::calibration, blob);
      REQUIRE_MESSAGE(sent, sent.error().message);
      const auto& counts = device.port.counts();
      if (kind != FaultKind::none) CHECK(counts.lost + counts.altered + counts.repeated >= 5);
      device.port.set_plan(FaultPlan(FaultKind::none, 0, 1));
      REQUIRE(session->start({}, {}));  // and the device streams as before
      session->stop();
      session.reset();
      CHECK(device.store.kept(BlobKind::calibration) == blob);
      CHECK(device.store.kept(BlobKind::firmware).empty());
    }
  }
}

TEST_CASE("faults: a cable on which every block is lost is told, and one that is pulled") {
  const auto blob = some_blob(50'000);
  for (const Bus& bus : kBuses) {
    CAPTURE(std::string(bus.name));
    Device device;
    auto session = open_session(bus, device.port);
    device.port.set_plan(FaultPlan(FaultKind::drop, 1, 1));
    const auto lost = session->send_blob(BlobKind::firmware, blob);
    REQUIRE_FALSE(lost);
    CHECK(lost.error().code == ErrorCode::io_failed);
    device.loopback.unplug();
    const auto pulled = session->send_blob(BlobKind::firmware, blob);
    REQUIRE_FALSE(pulled);
    CHECK(pulled.error().code == ErrorCode::transport_closed);
    session.reset();
    CHECK(device.store.kept(BlobKind::firmware).empty());
  }
}

TEST_CASE("faults: the cable may be pulled within any block of a blob, and within any request about it") {
  const auto blob = some_blob(20'000);
  for (const Bus& bus : kBuses) {
    CAPTURE(std::string(bus.name));
    std::uint64_t requests = 0;
    for (bool pulled = true; pulled; ++requests) {
      Device device;
      device.port.set_plan(FaultPlan::once(FaultKind::disconnect_reply, requests, 3));
      auto session = device::Session::open(bus.connect(device.port));
      if (!session) continue;
      const auto sent = (*session)->send_blob(BlobKind::firmware, blob);
      pulled = device.port.dead();
      CHECK(sent.has_value() == !pulled);
    }
    MESSAGE(std::string(bus.name) << ": " << requests - 1 << " requests");
    CHECK(requests > 6);
  }
}

TEST_CASE("faults: a blob that nobody takes is refused before anything is sent") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1));
  auto session = open_session(loopback.port());
  const auto blob = some_blob(100);
  CHECK(session->send_blob(BlobKind::firmware, blob).error().code == ErrorCode::not_available);
  Device device;
  auto able = open_session(device.port);
  CHECK(able->send_blob(BlobKind::firmware, {}).error().code == ErrorCode::invalid_argument);
  CHECK(able->send_blob(static_cast<BlobKind>(9), blob).error().code == ErrorCode::refused_by_device);
  REQUIRE(able->start({}, {}));
  CHECK(able->send_blob(BlobKind::firmware, blob).error().code == ErrorCode::wrong_state);
  able->stop();
  CHECK(able->send_blob(BlobKind::firmware, blob));
}
