#include "tests/unit/record/recordings.h"

using namespace sonoloft;
using namespace sonoloft::record;
using namespace sonoloft::test;
using device::EventKind;

namespace {

std::unique_ptr<device::Session> replayed(const std::filesystem::path& path, double speed = 0) {
  auto transport = ReplayTransport::open(path, speed);
  if (!transport) FAIL(transport.error().message);
  auto session = device::Session::open(std::move(*transport));
  if (!session) FAIL(session.error().message);
  return std::move(*session);
}

void check_same(const Delivered& a, const Delivered& b) {
  REQUIRE(a.slices.size() == b.slices.size());
  for (std::size_t i = 0; i < a.slices.size(); ++i) CHECK(same(*a.slices[i], *b.slices[i]));
  CHECK(a.ledger == b.ledger);
}

}  // namespace

TEST_CASE("replay: a session gets the slices that were recorded, and its books close, at any speed") {
  const TemporaryFolder folder;
  const Delivered recorded = record_run(folder.path("a.mcap"), 50);
  CHECK(recorded.slices.size() == 50);
  for (const double speed : {0.0, 1000.0, 20.0}) {
    const auto session = replayed(folder.path("a.mcap"), speed);
    const Delivered again = run_to_end(*session);
    check_closed(again.ledger);
    check_same(recorded, again);
    CHECK(session->info().serial == "LOOP-1");
  }
}

TEST_CASE("replay: a recorded replay is the same recording") {
  const TemporaryFolder folder;
  const Delivered recorded = record_run(folder.path("a.mcap"), 20);
  auto replay = ReplayTransport::open(folder.path("a.mcap"), 0);
  REQUIRE(replay);
  const auto recorder = Recorder::create(folder.path("b.mcap"));
  REQUIRE(recorder);
  auto session = device::Session::open(std::make_unique<RecordingTransport>(std::move(*replay), *recorder));
  REQUIRE(session);
  check_same(recorded, run_to_end(**session));
  REQUIRE((*recorder)->close());
  check_same(recorded, run_to_end(*replayed(folder.path("b.mcap"))));
}

TEST_CASE("replay: every run of a session gets the next recorded one, after the last there is nothing more") {
  const TemporaryFolder folder;
  device_sim::LoopbackDevice device(loopback_options(), numbered_slices(30));
  const auto recorder = Recorder::create(folder.path("a.mcap"));
  REQUIRE(recorder);
  auto session = device::Session::open(
      std::make_unique<RecordingTransport>(std::make_unique<device::LoopbackTransport>(device.port()), *recorder));
  REQUIRE(session);
  Inbox first;
  REQUIRE((*session)->start({device::StreamMode::lossless, 1}, first.callbacks()));
  REQUIRE(first.wait_for_slices(3));
  (*session)->stop();
  const Delivered second = run_to_end(**session);
  REQUIRE((*recorder)->close());

  auto transport = ReplayTransport::open(folder.path("a.mcap"), 0);
  REQUIRE(transport);
  const ReplayTransport& replay = **transport;
  CHECK(replay.facts().runs == 2);
  CHECK(replay.more());
  auto again = device::Session::open(std::move(*transport));
  REQUIRE(again);
  const Delivered first_again = run_to_end(**again);
  CHECK(first_again.slices.size() >= first.slices().size());  // some that were never delivered had come
  CHECK(replay.more());
  const Delivered second_again = run_to_end(**again);
  REQUIRE(second_again.slices.size() == second.slices.size());
  for (std::size_t i = 0; i < second.slices.size(); ++i) CHECK(same(*second.slices[i], *second_again.slices[i]));
  CHECK(!replay.more());
  CHECK(run_to_end(**again).slices.empty());
}

TEST_CASE("replay: a probe that was unplugged goes away again, and is found again for the next run") {
  const TemporaryFolder folder;
  device_sim::LoopbackDevice device(loopback_options(), numbered_slices(100));
  const auto recorder = Recorder::create(folder.path("a.mcap"));
  REQUIRE(recorder);
  auto session = device::Session::open(
      std::make_unique<RecordingTransport>(std::make_unique<device::LoopbackTransport>(device.port()), *recorder));
  REQUIRE(session);
  Inbox inbox;
  REQUIRE((*session)->start({device::StreamMode::lossless, 64}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(5));
  device.unplug();
  REQUIRE(inbox.wait_for(EventKind::disconnected));
  (*session)->stop();
  REQUIRE((*recorder)->close());

  const auto again = replayed(folder.path("a.mcap"));
  const Delivered lost = run_to_end(*again, EventKind::disconnected);
  CHECK(lost.slices.size() == inbox.slices().size());
  check_closed(lost.ledger);
  CHECK(run_to_end(*again).slices.empty());
}

TEST_CASE("replay: what the probe told by itself is told again, at its place, in the session of today") {
  const TemporaryFolder folder;
  {
    auto options = loopback_options();
    options.rate_hz = 100;
    device_sim::LoopbackDevice loopback(options, numbered_slices(1u << 30));
    auto recorder = record::Recorder::create(folder.path("a.mcap"));
    REQUIRE(recorder);
    auto session = device::Session::open(std::make_unique<record::RecordingTransport>(
        std::make_unique<device::LoopbackTransport>(loopback.port()), *recorder));
    REQUIRE(session);
    Inbox inbox;
    REQUIRE((*session)->start({}, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(3));
    loopback.button(6, true);
    REQUIRE(inbox.wait_for(device::EventKind::button));
    (*session)->stop();
    session->reset();
    REQUIRE((*recorder)->close());
  }
  auto replay = record::ReplayTransport::open(folder.path("a.mcap"), 0);
  REQUIRE(replay);
  auto session = device::Session::open(std::move(*replay));
  REQUIRE(session);
  Inbox inbox;
  REQUIRE((*session)->start({device::StreamMode::lossless, 16}, inbox.callbacks()));
  REQUIRE(inbox.wait_for(device::EventKind::end_of_data));
  (*session)->stop();
  REQUIRE(inbox.count(device::EventKind::button) == 1);
  CHECK(inbox.events()[0].button->number == 6);
  CHECK((*session)->statistics().events_lost == 0);
}

TEST_CASE("replay: stop() ends it in the middle, however slow it is") {
  const TemporaryFolder folder;
  record_run(folder.path("a.mcap"), 50);
  const auto session = replayed(folder.path("a.mcap"), 1e-3);
  Inbox inbox;
  REQUIRE(session->start({}, inbox.callbacks()));
  session->stop();
  CHECK(inbox.slices().size() < 50);
  check_closed(session->ledger());
}
