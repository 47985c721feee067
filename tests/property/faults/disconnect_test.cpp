#include <doctest/doctest.h>

#include "device_sim/port/fault/faulty_port.h"
#include "tests/property/faults/bus.h"
#include "tests/property/faults/witness.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device_sim::FaultKind;
using device_sim::FaultPlan;
using device_sim::FaultyPort;

namespace {

void check(const device::Ledger& ledger, const Witness& witness) {
  check_closed(ledger);
  CHECK(ledger.delivered == witness.delivered);
  CHECK(witness.wrong == 0);
  CHECK(witness.disconnected <= 1);
  CHECK(witness.after_the_end == 0);
}

// A whole life over a cable that is pulled within the index-th request or its reply. False: it was never pulled.
bool live(const Bus& bus, FaultKind kind, std::uint64_t index, std::size_t offset) {
  device_sim::LoopbackDevice loopback(loopback_options(4), numbered_small_slices(3));
  FaultyPort port(loopback.port());
  port.set_plan(FaultPlan::once(kind, index, offset));
  auto session = device::Session::open(bus.connect(port));
  if (!session) {
    CHECK(port.dead());
    return true;
  }
  Witness witness((*session)->calibration());
  if (const auto started = (*session)->start({}, witness.callbacks()); !started) {
    CHECK(port.dead());
    CHECK(witness.delivered == 0);
    return true;
  }
  (*session)->stop();
  check((*session)->ledger(), witness);
  return port.dead();
}

// A stream over a cable that is pulled within its third record.
void stream(const Bus& bus, std::size_t offset) {
  const auto open = std::make_shared<std::atomic<bool>>(false);
  device_sim::LoopbackDevice loopback(loopback_options(4), gated_slices(10, 0, open));
  FaultyPort port(loopback.port());
  auto session = open_session(bus, port);
  port.set_plan(FaultPlan::once(FaultKind::disconnect, 2, offset));
  Inbox inbox;
  Witness witness(session->calibration());
  auto callbacks = witness.callbacks();
  callbacks.on_event = [&, tell = callbacks.on_event](const device::Event& event) {
    tell(event);
    inbox.add(event);
  };
  const auto started = session->start({device::StreamMode::lossless, 64}, callbacks);
  *open = true;
  REQUIRE(started);
  REQUIRE(inbox.wait_for(device::EventKind::disconnected));
  session->stop();
  check(session->ledger(), witness);
  CHECK(witness.delivered == 2);
  CHECK(session->ledger().malformed == 1);
  CHECK(witness.disconnected == 1);
}

}  // namespace

TEST_CASE("faults: the cable may be pulled at every byte of a record") {
  auto slice = make_numbered(2);
  const std::size_t size = make_record(slice.view()).size();
  for (const Bus& bus : kBuses) {
    CAPTURE(std::string(bus.name));
    for (std::size_t offset = 0; offset < size; ++offset) {
      CAPTURE(offset);
      stream(bus, offset);
    }
    MESSAGE(std::string(bus.name) << ": " << size << " offsets");
  }
}

TEST_CASE("faults: the cable may be pulled at every byte of every request and of every reply") {
  for (const Bus& bus : kBuses) {
    CAPTURE(std::string(bus.name));
    std::size_t lives = 0;
    for (const FaultKind kind : {FaultKind::disconnect_request, FaultKind::disconnect_reply}) {
      // The messages of a life: STOP GET_INFO GET_CALIBRATION, STOP, 8 TIME_SYNC, START, STOP, GET_STATS.
      const std::size_t longest = kind == FaultKind::disconnect_request ? 20 : 112;
      std::uint64_t index = 0;
      for (bool pulled = true; pulled; ++index) {
        for (std::size_t offset = 0; offset < longest && pulled; ++offset, ++lives) {
          CAPTURE(index);
          CAPTURE(offset);
          pulled = live(bus, kind, index, offset);
        }
      }
      CHECK(index >= 14);
    }
    MESSAGE(std::string(bus.name) << ": " << lives << " lives");
  }
}
