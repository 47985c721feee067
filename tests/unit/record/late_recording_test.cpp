// Recordings that begin and end while a probe streams.
#include <atomic>
#include <functional>
#include <numeric>
#include <thread>

#include "tests/unit/record/recordings.h"

using namespace sonoloft;
using namespace sonoloft::record;
using namespace sonoloft::test;

namespace {

using Ids = std::vector<std::uint64_t>;

/// A transport that says after each transfer, on the event thread, how many came in all runs.
class Counting final : public device::Transport, private device::TransferSink {
 public:
  Counting(std::unique_ptr<RecordingTransport> inner, std::function<void(int)> after)
      : inner_(std::move(inner)), after_(std::move(after)) {}

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override {
    return inner_->control(request, reply, timeout);
  }
  Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override {
    sink_ = &sink;
    return inner_->start_stream(*this, max_record);
  }
  void stop_stream() override { inner_->stop_stream(); }

 private:
  void on_transfer(std::span<const std::byte> transfer) override {
    sink_->on_transfer(transfer);
    after_(++count_);
  }
  void on_gone() override { sink_->on_gone(); }

  const std::unique_ptr<RecordingTransport> inner_;
  const std::function<void(int)> after_;
  device::TransferSink* sink_ = nullptr;
  int count_ = 0;
};

/// A session with a device of `slices` slices a run that can be recorded.
struct Recordable {
  explicit Recordable(
      std::uint32_t slices, std::function<void(int)> after = [](int) {})
      : device(loopback_options(), numbered_slices(slices)) {
    auto inner = std::make_unique<RecordingTransport>(std::make_unique<device::LoopbackTransport>(device.port()));
    transport = inner.get();
    auto opened = device::Session::open(std::make_unique<Counting>(std::move(inner), std::move(after)));
    REQUIRE(opened);
    session = std::move(*opened);
  }

  device_sim::LoopbackDevice device;
  RecordingTransport* transport;  ///< the session's
  std::unique_ptr<device::Session> session;
};

/// A run in which few slices come before START is answered, because the first callbacks come after that.
Delivered run_held_back(device::Session& session) {
  return run_to_end(session, device::EventKind::end_of_data, 1);
}

std::shared_ptr<Recorder> recorder_of(const std::filesystem::path& path) {
  auto recorder = Recorder::create(path);
  if (!recorder) FAIL(recorder.error().message);
  return *recorder;
}

void close(Recorder& recorder) {
  CHECK(recorder.close());
  CHECK(recorder.figures().not_recorded == 0);
}

Ids ids_of(const Delivered& run) {
  Ids ids;
  for (const auto& slice : run.slices) ids.push_back(slice->slice.id);
  return ids;
}

Ids from_to(std::uint64_t first, std::uint64_t end) {
  Ids ids(end - first);
  std::iota(ids.begin(), ids.end(), first);
  return ids;
}

/// All runs of a recording.
std::vector<Delivered> replay(const std::filesystem::path& path) {
  auto transport = ReplayTransport::open(path, 0);
  if (!transport) FAIL(transport.error().message);
  const ReplayTransport& recorded = **transport;
  auto session = device::Session::open(std::move(*transport));
  if (!session) FAIL(session.error().message);
  std::vector<Delivered> runs;
  while (recorded.more()) runs.push_back(run_to_end(**session));
  return runs;
}

}  // namespace

TEST_CASE("recording: parts of a run replay what came between their beginnings and ends, the rest counts as lost") {
  const TemporaryFolder folder;
  const auto a = recorder_of(folder.path("a.mcap")), b = recorder_of(folder.path("b.mcap")),
             c = recorder_of(folder.path("c.mcap"));
  RecordingTransport* transport = nullptr;
  Recordable probe(50, [&](int count) {
    if (count == 20) transport->record(a);
    if (count == 30) transport->end_recording();
    if (count == 35) transport->record(b);
    if (count == 40) transport->record(c);
  });
  transport = probe.transport;
  const Delivered all = run_held_back(*probe.session);
  transport->end_recording();
  for (const auto& recorder : {a, b, c}) close(*recorder);

  const auto check = [&](const char* name, std::uint64_t first, std::uint64_t end) {
    const auto runs = replay(folder.path(name));
    REQUIRE(runs.size() == 1);
    CHECK(ids_of(runs[0]) == from_to(first, end));
    for (const auto& slice : runs[0].slices) CHECK(same(*slice, *all.slices.at(slice->slice.id)));
    check_closed(runs[0].ledger);
    CHECK(runs[0].ledger.made == end);
    CHECK(runs[0].ledger.transport_lost == first);
  };
  check("a.mcap", 20, 30);
  check("b.mcap", 35, 40);
  check("c.mcap", 40, 50);
}

TEST_CASE("recording: one that begins in a run and ends in the next one has two runs") {
  const TemporaryFolder folder;
  const auto recorder = recorder_of(folder.path("a.mcap"));
  RecordingTransport* transport = nullptr;
  std::atomic<int> came = 0, came_first = 1 << 30;
  Recordable probe(300, [&](int count) {
    came = count;
    if (count == 10) transport->record(recorder);
    if (count == came_first + 15) transport->end_recording();
  });
  transport = probe.transport;
  Inbox inbox;
  REQUIRE(probe.session->start({device::StreamMode::lossless, 1}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(20));
  probe.session->stop();
  came_first = came.load();
  REQUIRE(run_held_back(*probe.session).slices.size() > 15);
  close(*recorder);
  const auto runs = replay(folder.path("a.mcap"));
  REQUIRE(runs.size() == 2);
  CHECK(ids_of(runs[0]) == from_to(10, static_cast<std::uint64_t>(came_first)));
  CHECK(ids_of(runs[1]) == from_to(0, 15));
}

TEST_CASE("recording: one may begin and end while nothing comes, in a run and between runs") {
  const TemporaryFolder folder;
  const auto between = recorder_of(folder.path("a.mcap")), silent = recorder_of(folder.path("b.mcap"));
  Recordable probe(5);
  probe.transport->record(between);
  Inbox inbox;
  REQUIRE(probe.session->start({device::StreamMode::lossless, 64}, inbox.callbacks()));
  REQUIRE(inbox.wait_for(device::EventKind::end_of_data));
  probe.transport->end_recording();
  close(*between);
  probe.transport->record(silent);
  probe.transport->end_recording();
  probe.session->stop();
  close(*silent);

  const auto whole = replay(folder.path("a.mcap")), empty = replay(folder.path("b.mcap"));
  REQUIRE(whole.size() == 1);
  CHECK(ids_of(whole[0]) == from_to(0, 5));
  CHECK(whole[0].ledger.transport_lost == 0);
  REQUIRE(empty.size() == 1);
  CHECK(empty[0].slices.empty());
}

TEST_CASE("recording: beginning and ending from another thread, at any moment, leaves no gap in any recording") {
  constexpr std::size_t kRecordings = 12;
  const TemporaryFolder folder;
  const auto path = [&](std::size_t i) { return folder.path(std::to_string(i) + ".mcap"); };
  std::atomic<int> came = 0;
  Recordable probe(1u << 30, [&](int count) { came = count; });
  Inbox inbox;
  REQUIRE(probe.session->start({device::StreamMode::lossless, 64}, inbox.callbacks()));
  const auto wait_for_some = [&] {
    for (const int enough = came + 10; came < enough;) std::this_thread::yield();
  };
  for (std::size_t i = 0; i < kRecordings; ++i) {
    const auto recorder = recorder_of(path(i));
    probe.transport->record(recorder);
    wait_for_some();
    probe.transport->end_recording();
    close(*recorder);
    wait_for_some();
  }
  probe.session->stop();

  std::uint64_t end = 0, slices = 0;
  for (std::size_t i = 0; i < kRecordings; ++i) {
    const auto runs = replay(path(i));
    REQUIRE(runs.size() == 1);
    const Ids ids = ids_of(runs[0]);
    REQUIRE(ids.size() >= 9);  // of 10, one may have come to be counted before
    CHECK(ids.front() >= end);
    end = ids.front() + ids.size();
    CHECK(ids == from_to(ids.front(), end));
    slices += ids.size();
  }
  MESSAGE(slices, " of ", came.load(), " slices in ", kRecordings, " recordings");
}
