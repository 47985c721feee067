// What a callback may do: take its time, throw, stop the scan.
#include <doctest/doctest.h>

#include <atomic>
#include <future>
#include <stdexcept>
#include <thread>
#include <utility>

#include "tests/support/ball_scan.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr std::uint32_t kSlices = 24;

std::uint64_t total(const SliceCounts& c) {
  return c.inserted + c.explained + c.merged + c.refused + c.dropped;
}

/// Blocks a callback until the scan has got so many slices.
void wait_for_delivered(const ScanSession& scan, std::uint64_t count) {
  while (scan.counts().delivered < count) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

TEST_CASE("callbacks: a slow one gets the latest mesh next, and what it missed is counted") {
  std::promise<void> first_call;
  const auto after_first = [called = first_call.get_future().share()](std::uint32_t i, OwnedWireSlice&) {
    if (i == 1) called.wait();
  };
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, false, after_first));
  std::unique_ptr<ScanSession> scan;
  bool first = true;
  ScanInbox inbox([&](const MeshUpdate&) {
    if (!std::exchange(first, false)) return;
    first_call.set_value();
    wait_for_delivered(*scan, kSlices);
  });
  auto options = ball_scan_options();
  options.queue_capacity = kSlices;
  scan = open_scan(device.port(), options);
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();

  const auto updates = inbox.updates();
  REQUIRE(updates.size() == 2);
  CHECK(updates[1]->revision == kSlices);
  CHECK(updates[0]->slices.size() == 1);
  CHECK(updates[1]->slices.size() == kSlices - 1);
  CHECK(updates[1]->skipped_revisions == kSlices - 2);
  CHECK(updates[1]->counts.dropped == 0);
}

TEST_CASE("callbacks: of a live scan the oldest slices give way to newer ones, counted") {
  auto options = ball_scan_options();
  options.stream.mode = device::StreamMode::live;
  options.queue_capacity = 4;
  auto device_options = ball_device_options();
  device_options.rate_hz = 500;
  device_sim::LoopbackDevice device(device_options, ball_source(kSlices, true));
  std::unique_ptr<ScanSession> scan;
  std::size_t calls = 0;
  ScanInbox inbox([&](const MeshUpdate&) {
    if (++calls == 1) wait_for_delivered(*scan, scan->counts().delivered + 20);
    if (calls == 2) scan->stop();
  });
  scan = open_scan(device.port(), options);
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for_updates(2));
  scan->stop();

  const auto updates = inbox.updates();
  REQUIRE(updates.size() == 2);
  CHECK(updates[1]->slices.size() == 4);
  CHECK(updates[1]->counts.dropped >= 16);
  CHECK(updates[1]->slices.front().slice->slice.id > updates[0]->slices.back().slice->slice.id + 16);
  CHECK(total(scan->counts()) == scan->counts().delivered);
  CHECK(scan->ledger().closed);
}

TEST_CASE("callbacks: the event of dropped slices comes once for each time the queue runs over") {
  auto options = ball_scan_options();
  options.stream.mode = device::StreamMode::live;
  options.queue_capacity = 2;
  auto device_options = ball_device_options();
  device_options.rate_hz = 500;
  device_sim::LoopbackDevice device(device_options, ball_source(kSlices, true));
  std::unique_ptr<ScanSession> scan;
  std::atomic<std::size_t> calls = 0;
  ScanInbox inbox([&](const MeshUpdate&) {
    if (++calls <= 3) wait_for_delivered(*scan, scan->counts().delivered + 10);
  });
  scan = open_scan(device.port(), options);
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for_updates(4));
  scan->stop();
  const std::size_t events = inbox.count(ScanEventKind::slices_dropped);
  CHECK(events >= 2);
  CHECK(events <= inbox.updates().size());
}

TEST_CASE("callbacks: stop() inside on_mesh returns at once and that callback was the last") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, true));
  std::unique_ptr<ScanSession> scan;
  std::atomic<int> after_stop = 0, calls = 0;
  ScanCallbacks callbacks;
  callbacks.on_mesh = [&](std::shared_ptr<const MeshUpdate>) {
    if (calls.fetch_add(1) == 2) scan->stop();
    if (calls > 3) ++after_stop;
  };
  callbacks.on_event = [&](const ScanEvent&) { ++after_stop; };
  scan = open_scan(device.port());
  REQUIRE(scan->start(callbacks));
  while (calls < 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  scan->stop();
  CHECK(calls == 3);
  CHECK(after_stop == 0);
  CHECK(scan->ledger().closed);
  CHECK(total(scan->counts()) == scan->counts().delivered);
}

TEST_CASE("callbacks: stop() inside on_event is the last callback, too") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  std::unique_ptr<ScanSession> scan;
  std::atomic<int> events = 0;
  ScanCallbacks callbacks;
  callbacks.on_event = [&](const ScanEvent& event) {
    CHECK(event.kind == ScanEventKind::end_of_data);
    ++events;
    scan->stop();
  };
  scan = open_scan(device.port());
  REQUIRE(scan->start(callbacks));
  while (events == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  scan->stop();
  CHECK(events == 1);
  CHECK(scan->counts().inserted == kSlices);
}

TEST_CASE("callbacks: an exception becomes an event and the scan goes on") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  std::size_t calls = 0;
  ScanInbox inbox([&](const MeshUpdate&) {
    if (++calls == 1) throw std::runtime_error("no space left on my disk");
    throw 42;
  });
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  CHECK(scan->counts().inserted == kSlices);
  const auto events = inbox.events();
  REQUIRE(events.size() == calls + 1);
  for (std::size_t i = 0; i < calls; ++i) CHECK(events[i].kind == ScanEventKind::callback_threw);
  CHECK(events[0].message.find("no space left on my disk") != std::string::npos);
}

TEST_CASE("callbacks: an exception out of on_event, and after stop(), reaches nobody") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  std::unique_ptr<ScanSession> scan;
  std::atomic<int> meshes = 0, events = 0;
  ScanCallbacks callbacks;
  callbacks.on_mesh = [&](std::shared_ptr<const MeshUpdate>) {
    if (++meshes == 2) scan->stop();
    throw std::runtime_error("never mind");
  };
  callbacks.on_event = [&](const ScanEvent&) {
    ++events;
    throw std::runtime_error("nor this");
  };
  scan = open_scan(device.port());
  REQUIRE(scan->start(callbacks));
  while (meshes < 2 && scan->counts().inserted < kSlices) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  scan->stop();
  CHECK(events >= 1);
  CHECK(events <= 2);
  CHECK(scan->ledger().closed);
}

TEST_CASE("callbacks: all run on one thread, which is none of the caller's") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  std::vector<std::thread::id> threads;  // no lock: one call at a time
  std::atomic<bool> ended = false;
  ScanCallbacks callbacks;
  callbacks.on_mesh = [&](std::shared_ptr<const MeshUpdate>) { threads.push_back(std::this_thread::get_id()); };
  callbacks.on_event = [&](const ScanEvent&) {
    threads.push_back(std::this_thread::get_id());
    ended = true;
  };
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(callbacks));
  while (!ended) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  scan->stop();
  REQUIRE(threads.size() >= 2);
  for (const auto id : threads) {
    CHECK(id == threads.front());
    CHECK(id != std::this_thread::get_id());
  }
}
