// What a device tells by itself, from the firmware to a session's callbacks.
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/support/wire/loopback_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;

namespace {

device_sim::LoopbackOptions at_50_hz() {
  auto options = loopback_options();
  options.rate_hz = 50;
  return options;
}

}  // namespace

TEST_CASE("events: a button of the probe reaches the callback, with its number and the time on both clocks") {
  device_sim::LoopbackDevice loopback(at_50_hz(), numbered_slices(1u << 30));
  auto session = open_session(loopback.port());
  Inbox inbox;
  const auto before = std::chrono::steady_clock::now();
  REQUIRE(session->start({}, inbox.callbacks()));
  loopback.button(2, true);
  loopback.button(2, false);
  REQUIRE(inbox.wait_for(EventKind::button, 2));
  session->stop();
  loopback.button(3, true);  // nobody hears it
  const auto events = inbox.events();
  REQUIRE(events.size() == 2);
  for (const bool pressed : {true, false}) {
    const auto& event = events[pressed ? 0 : 1];
    REQUIRE(event.button);
    CHECK(event.button->number == 2);
    CHECK(event.button->pressed == pressed);
    REQUIRE(event.button->host_time);
    CHECK(event.button->host_time->time > before - event.button->host_time->uncertainty);
    CHECK(event.button->host_time->time < std::chrono::steady_clock::now() + event.button->host_time->uncertainty);
  }
  CHECK(events[0].message == "button 2 of the probe was pressed");
  CHECK(session->statistics().events_lost == 0);
}

TEST_CASE("events: while a slice callback keeps a lossless stream waiting, buttons still arrive, behind it") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  auto session = open_session(loopback.port());
  Inbox inbox;
  std::atomic<bool> hold = true;
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](auto slice) {
    inbox.add(std::move(slice));
    hold.wait(true);
  };
  REQUIRE(session->start({device::StreamMode::lossless, 2}, callbacks));
  REQUIRE(inbox.wait_for_slices(1));
  // More than have room: that some of them were turned away shows that all came this far while the stream stood.
  while (session->statistics().events_lost == 0) {
    loopback.button(0, true);
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  CHECK(inbox.count(EventKind::button) == 0);
  hold = false;
  hold.notify_all();
  REQUIRE(inbox.wait_for(EventKind::button, 1));
  session->stop();
  check_closed(session->ledger());
}

TEST_CASE("events: a device that never ends telling of buttons costs no memory, and is counted") {
  device_sim::LoopbackDevice loopback(at_50_hz(), numbered_slices(1u << 30));
  auto session = open_session(loopback.port());
  Inbox inbox;
  std::atomic<bool> hold = true;
  auto callbacks = inbox.callbacks();
  callbacks.on_event = [&](const device::Event& event) {
    inbox.add(event);
    hold.wait(true);
  };
  REQUIRE(session->start({}, callbacks));
  std::uint32_t pressed = 0;
  for (; session->statistics().events_lost < 100; ++pressed) {
    loopback.button(1, true);
    if (pressed % 8 == 7) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(session->statistics().events_lost + 256 + 1 <= pressed);  // one is in the callback
  hold = false;
  hold.notify_all();
  REQUIRE(inbox.wait_for(EventKind::button, 257));
  session->stop();
}

TEST_CASE("events: those that were lost on the way are counted, altered ones are nothing") {
  class Lossy final : public protocol::Port {
   public:
    explicit Lossy(protocol::Port& port) : port_(port) {}
    ~Lossy() = default;
    protocol::PortTransfer control(std::span<const std::byte> request, std::span<std::byte> reply) override {
      return port_.control(request, reply);
    }
    protocol::PortTransfer read(std::span<std::byte> record, std::uint32_t timeout_ms) override {
      return port_.read(record, timeout_ms);
    }
    protocol::PortTransfer read_event(std::span<std::byte> event, std::uint32_t timeout_ms) override {
      const auto done = port_.read_event(event, timeout_ms);
      if (done.status == protocol::PortStatus::ok && ++events_ % 3 == 0) event[9] ^= std::byte{1};
      return done;
    }
    protocol::PortTransfer write_block(std::span<const std::byte> block) override { return port_.write_block(block); }
    void cancel_reads() override { port_.cancel_reads(); }
    void allow_reads() override { port_.allow_reads(); }

   private:
    protocol::Port& port_;
    int events_ = 0;
  };
  device_sim::LoopbackDevice loopback(at_50_hz(), numbered_slices(1u << 30));
  Lossy lossy(loopback.port());
  auto session = open_session(lossy);
  Inbox inbox;
  REQUIRE(session->start({}, inbox.callbacks()));
  for (std::uint16_t i = 0; i < 10; ++i) {
    loopback.button(i, true);
    REQUIRE(inbox.wait_for(EventKind::button, i + 1u - (i + 1u) / 3));  // of every three one is altered
  }
  session->stop();
  CHECK(inbox.count(EventKind::button) == 7);
  CHECK(session->statistics().events_lost == 3);
}
