// How a scan begins and ends.
#include <doctest/doctest.h>

#include <atomic>
#include <future>
#include <thread>

#include "tests/support/ball_scan.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr std::uint32_t kSlices = 16;

/// A transport that owns its device and tells when both are gone.
class OwningTransport final : public device::Transport {
 public:
  explicit OwningTransport(std::promise<void> gone)
      : gone_(std::move(gone)), device_(ball_device_options(), ball_source(kSlices, true)), inner_(device_.port()) {}
  ~OwningTransport() override { gone_.set_value(); }

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override {
    return inner_.control(request, reply, timeout);
  }
  Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override {
    return inner_.start_stream(sink, max_record);
  }
  void stop_stream() override { inner_.stop_stream(); }

 private:
  std::promise<void> gone_;
  device_sim::LoopbackDevice device_;
  device::LoopbackTransport inner_;
};

}  // namespace

TEST_CASE("life: a scan is destroyed inside its own callback, and its transport is closed soon after") {
  std::promise<void> gone;
  auto closed = gone.get_future();
  std::atomic<int> calls = 0, calls_after = 0;
  std::promise<std::unique_ptr<ScanSession>> to_callback;
  auto scan_of_callback = to_callback.get_future();
  auto opened = ScanSession::open(std::make_unique<OwningTransport>(std::move(gone)), ball_scan_options());
  REQUIRE(opened);
  ScanSession& scan = **opened;
  ScanCallbacks callbacks;
  callbacks.on_mesh = [&](std::shared_ptr<const MeshUpdate>) {
    if (calls.fetch_add(1) == 0)
      scan_of_callback.get().reset();
    else
      ++calls_after;
  };
  callbacks.on_event = [&](const ScanEvent&) { ++calls_after; };
  REQUIRE(scan.start(callbacks));
  to_callback.set_value(std::move(*opened));
  REQUIRE(closed.wait_for(std::chrono::seconds(60)) == std::future_status::ready);
  CHECK(calls == 1);
  CHECK(calls_after == 0);
}

TEST_CASE("life: a scan may be destroyed unstarted, running, stopped, and after the device went away") {
  SUBCASE("unstarted") {
    device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
    CHECK(open_scan(device.port())->counts() == SliceCounts{});
  }
  SUBCASE("running") {
    device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, true));
    std::atomic<int> calls = 0;
    ScanCallbacks callbacks;
    callbacks.on_mesh = [&](std::shared_ptr<const MeshUpdate>) { ++calls; };
    auto scan = open_scan(device.port());
    REQUIRE(scan->start(callbacks));
    while (calls < 2) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    scan.reset();
    const int at_end = calls;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    CHECK(calls == at_end);
    CHECK(device.stats().next_seq > 0);
  }
  SUBCASE("unplugged") {
    device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, true));
    ScanInbox inbox;
    auto scan = open_scan(device.port());
    REQUIRE(scan->start(inbox.callbacks()));
    REQUIRE(inbox.wait_for_updates(2));
    device.unplug();
    REQUIRE(inbox.wait_for(ScanEventKind::disconnected));
    CHECK(inbox.count(ScanEventKind::disconnected) == 1);
    CHECK(inbox.events().back().kind == ScanEventKind::disconnected);
    const auto last = inbox.updates().back();
    CHECK(last->revision == scan->counts().delivered - scan->counts().dropped);
    scan.reset();
    CHECK(inbox.updates().back() == last);
  }
}

TEST_CASE("life: start() says what it is called for at the wrong time") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  std::unique_ptr<ScanSession> scan;
  std::vector<ErrorCode> inside;
  ScanInbox inbox([&](const MeshUpdate&) {
    const auto again = scan->start({});
    if (!again) inside.push_back(again.error().code);
  });
  scan = open_scan(device.port());
  scan->stop();  // legal at any time
  REQUIRE(scan->start(inbox.callbacks()));
  const auto twice = scan->start({});
  REQUIRE(!twice);
  CHECK(twice.error().code == ErrorCode::wrong_state);
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  CHECK(inside == std::vector<ErrorCode>(inbox.updates().size(), ErrorCode::wrong_state));
}

TEST_CASE("life: a run that cannot start leaves the scan stopped") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  const auto scan = open_scan(device.port());
  device.unplug();
  for (int i = 0; i < 2; ++i) {
    const auto started = scan->start({});
    REQUIRE(!started);
    CHECK(started.error().code == ErrorCode::transport_closed);
  }
}

TEST_CASE("life: a second run goes on with the mesh of the first") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, true));
  std::unique_ptr<ScanSession> scan;
  ScanInbox first([&](const MeshUpdate&) { scan->stop(); }), second;  // with at most three of the slices
  scan = open_scan(device.port());
  REQUIRE(scan->start(first.callbacks()));
  REQUIRE(first.wait_for_updates(1));
  scan->stop();
  const auto before = first.updates().back();
  REQUIRE(scan->start(second.callbacks()));
  REQUIRE(second.wait_for_updates(kSlices));  // wherever in its round the device was: every slice of it
  scan->stop();
  const auto after = second.updates();
  CHECK(after.front()->revision == before->revision + after.front()->slices.size());
  CHECK(after.back()->counts.inserted > before->counts.inserted);
  CHECK(after.back()->size.cells > before->size.cells);
  CHECK(first.updates().back() == before);
}

TEST_CASE("life: two scans at once do not know of each other") {
  device_sim::LoopbackDevice device_a(ball_device_options(), ball_source(kSlices)),
      device_b(ball_device_options(), ball_source(kSlices));
  ScanInbox a, b;
  const auto scan_a = open_scan(device_a.port()), scan_b = open_scan(device_b.port());
  REQUIRE(scan_a->start(a.callbacks()));
  REQUIRE(scan_b->start(b.callbacks()));
  REQUIRE(a.wait_for(ScanEventKind::end_of_data));
  REQUIRE(b.wait_for(ScanEventKind::end_of_data));
  scan_b->stop();
  scan_a->stop();
  const IndexedMesh mesh_a = a.updates().back()->mesh.indexed(), mesh_b = b.updates().back()->mesh.indexed();
  CHECK(mesh_a.triangles.size() > 1000);
  CHECK(mesh_a.positions == mesh_b.positions);
  CHECK(mesh_a.triangles == mesh_b.triangles);
}

TEST_CASE("life: 30 short runs, stopped from outside at any moment, close their books") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices, true));
  const auto scan = open_scan(device.port());
  for (int i = 0; i < 30; ++i) {
    ScanInbox inbox;
    REQUIRE(scan->start(inbox.callbacks()));
    std::this_thread::sleep_for(std::chrono::microseconds(300 * i));
    scan->stop();
    REQUIRE(scan->ledger().closed);
    const SliceCounts c = scan->counts();
    REQUIRE(c.delivered == c.inserted + c.explained + c.merged + c.refused + c.dropped);
  }
}

TEST_CASE("life: options that cannot work are errors") {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
  const auto code = [&](const ScanOptions& options) {
    const auto scan = ScanSession::open(std::make_unique<device::LoopbackTransport>(device.port()), options);
    return scan ? ErrorCode{} : scan.error().code;
  };
  auto no_queue = ball_scan_options(), no_box = ball_scan_options(), no_spacing = ball_scan_options();
  no_queue.queue_capacity = 0;
  no_box.reconstructor.box.setEmpty();
  no_spacing.reconstructor.spacing_mm = 0;
  CHECK(code(no_queue) == ErrorCode::invalid_argument);
  CHECK(code(no_box) == ErrorCode::invalid_argument);
  CHECK(code(no_spacing) == ErrorCode::invalid_argument);
}
