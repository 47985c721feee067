#include <doctest/doctest.h>

#include <future>
#include <vector>

#include "device_sim/port/fault/faulty_port.h"
#include "tests/property/faults/bus.h"
#include "tests/property/faults/witness.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device_sim::FaultKind;
using device_sim::FaultPlan;

namespace {

struct End {
  bool told = false;
  std::uint64_t delivered = 0, wrong = 0, times_told = 0;
  device::Ledger ledger;
};

// A stream that ends with its sixth record, until the host has noticed.
End fall_silent(const Bus& bus, FaultKind kind) {
  device_sim::LoopbackDevice loopback(loopback_options(4), numbered_small_slices(100));
  device_sim::FaultyPort port(loopback.port());
  auto session = open_session(bus, port);
  port.set_plan(FaultPlan::once(kind, 5, 0));
  Inbox inbox;
  Witness witness(session->calibration());
  auto callbacks = witness.callbacks();
  callbacks.on_event = [&](const device::Event& event) {
    witness.disconnected += event.kind == device::EventKind::disconnected;
    inbox.add(event);
  };
  REQUIRE(session->start({device::StreamMode::lossless, 64}, callbacks));
  End end;
  end.told = inbox.wait_for(device::EventKind::disconnected);
  session->stop();
  end.delivered = witness.delivered;
  end.wrong = witness.wrong;
  end.times_told = witness.disconnected;
  end.ledger = session->ledger();
  return end;
}

}  // namespace

TEST_CASE("faults: a device that falls silent, with or without answers to requests, is given up and said to be gone") {
  std::vector<std::future<End>> pending;
  for (const Bus& bus : kBuses) {
    for (const FaultKind kind : {FaultKind::nak_for_ever, FaultKind::freeze})
      pending.push_back(std::async(std::launch::async, fall_silent, bus, kind));
  }
  for (std::size_t i = 0; i < pending.size(); ++i) {
    CAPTURE(i);
    const End end = pending[i].get();
    CHECK(end.told);
    CHECK(end.times_told == 1);
    CHECK(end.delivered == 5);
    CHECK(end.wrong == 0);
    check_closed(end.ledger);
  }
}
