// What on_slice sees of the slices.
#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/support/ball_scan.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr std::uint32_t kSlices = 24;
using SlicePtr = std::shared_ptr<const device::DeliveredSlice>;

}  // namespace

TEST_CASE("slices: each comes by once, in order, before the mesh that has it, whatever its pose is worth") {
  device_sim::LoopbackDevice device(ball_device_options(),
                                    ball_source(kSlices, false, [](std::uint32_t i, OwnedWireSlice& slice) {
                                      if (i % 6 == 5) slice.slice.pose.status = protocol::PoseStatus::out_of_view;
                                    }));
  std::vector<SlicePtr> seen;  // no lock: one call at a time
  std::vector<std::thread::id> threads;
  std::size_t in_meshes = 0;
  ScanInbox inbox([&](const MeshUpdate& update) {
    threads.push_back(std::this_thread::get_id());
    REQUIRE(seen.size() == in_meshes + update.slices.size());
    for (const SliceReport& report : update.slices) CHECK(report.slice == seen[in_meshes++]);
  });
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](SlicePtr slice) {
    threads.push_back(std::this_thread::get_id());
    seen.push_back(std::move(slice));
  };
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(callbacks));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();

  REQUIRE(seen.size() == kSlices);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    CHECK(seen[i]->slice.id == i);
    CHECK((seen[i]->pose_status == protocol::PoseStatus::ok) == (i % 6 != 5));
  }
  for (const auto id : threads) CHECK(id == threads.front());
  CHECK(scan->counts().refused == kSlices / 6);
}

TEST_CASE("slices: stop() inside on_slice makes it the last callback, and the slice counts as dropped") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, true));
  std::unique_ptr<ScanSession> scan;
  std::atomic<int> calls = 0, after_stop = 0;
  ScanCallbacks callbacks;
  callbacks.on_slice = [&](const SlicePtr& slice) {
    calls += 1;
    if (slice->slice.id == 5) scan->stop();
    if (slice->slice.id > 5) ++after_stop;
  };
  std::uint64_t in_meshes = 0;
  callbacks.on_mesh = [&](const std::shared_ptr<const MeshUpdate>& update) {
    in_meshes += update->slices.size();
    if (calls > 5) ++after_stop;
  };
  callbacks.on_event = [&](const ScanEvent&) { ++after_stop; };
  scan = open_scan(device.port());
  REQUIRE(scan->start(callbacks));
  while (calls < 6) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  scan->stop();
  CHECK(calls == 6);
  CHECK(after_stop == 0);
  const SliceCounts counts = scan->counts();
  CHECK(counts.inserted + counts.explained + counts.merged + counts.refused == in_meshes);
  CHECK(in_meshes + counts.dropped == counts.delivered);
  CHECK(scan->ledger().closed);
}

TEST_CASE("slices: an exception out of on_slice becomes an event, and the slice is used all the same") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  ScanInbox inbox;
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [](const SlicePtr& slice) {
    if (slice->slice.id == 3) throw std::runtime_error("no picture of this one");
  };
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(callbacks));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  CHECK(scan->counts().inserted == kSlices);
  const auto events = inbox.events();
  REQUIRE(events.size() == 2);
  CHECK(events[0].kind == ScanEventKind::callback_threw);
  CHECK(events[0].message == "on_slice threw: no picture of this one; catch it there");
}
