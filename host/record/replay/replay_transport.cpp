#include "host/record/replay/replay_transport.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <variant>

#include "host/record/replay/recording_index.h"
#include "host/record/replay/recording_reader.h"
#include "host/record/replay/replayed_probe.h"

namespace sonoloft::record {
namespace {

using Clock = std::chrono::steady_clock;

/// How long after a run's beginning something comes that was recorded at `time_ns`.
std::chrono::nanoseconds due_after(std::uint64_t first_ns, std::uint64_t time_ns, double speed) {
  constexpr double kLongest_ns = 1e18;  // whatever a file says
  const auto recorded = static_cast<double>(time_ns - std::min(first_ns, time_ns));
  return std::chrono::nanoseconds(std::llround(std::min(recorded / speed, kLongest_ns)));
}

tl::unexpected<Error> gone() {
  return fail(ErrorCode::transport_closed, "the recorded probe went away here: start again");
}

}  // namespace

struct ReplayTransport::State {
  State(RecordingIndex index, RecordingReader opened, double times_as_fast)
      : facts(std::move(index.facts)),
        streams(std::move(index.streams)),
        speed(times_as_fast),
        reader(std::move(opened)),
        probe(std::move(index.info), std::move(index.calibration)),
        to_come(facts.runs) {}

  const RecordingFacts facts;
  const std::vector<std::optional<std::uint32_t>> streams;
  const double speed;

  // The event thread's.
  RecordingReader reader;
  std::size_t streams_met = 0;  ///< in the file

  std::mutex mutex;  ///< guards what follows; never held while the sink is called
  std::condition_variable changed;
  ReplayedProbe probe;
  bool stopping = false, lost = false;
  std::size_t to_come;  ///< runs that were not begun

  std::jthread event_thread;

  void play(device::TransferSink& sink);
  std::optional<std::uint32_t> find_run();
  void serve(device::TransferSink& sink, std::uint32_t recorded_id);
  bool hand_over(device::TransferSink& sink, const Recorded& recorded, std::uint32_t recorded_id);
  bool wait_until(Clock::time_point due);
  void lose(device::TransferSink& sink);
  void end();
};

// ---- the event thread

void ReplayTransport::State::play(device::TransferSink& sink) {
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return stopping || probe.session_id(); });
    if (stopping) return;
  }
  if (const auto recorded_id = find_run())
    serve(sink, *recorded_id);
  else
    end();
}

/// Goes on to the next stream that was started. @return the id that its session had; nothing where there is none
std::optional<std::uint32_t> ReplayTransport::State::find_run() {
  for (auto next = reader.next(); next && *next; next = reader.next()) {
    const auto* mark = std::get_if<StreamMark>(&(*next)->what);
    if (mark == nullptr || *mark != StreamMark::opened || streams_met == streams.size()) continue;
    const auto id = streams[streams_met++];
    if (!id) continue;
    const std::lock_guard lock(mutex);
    --to_come;
    return id;
  }
  return std::nullopt;
}

void ReplayTransport::State::serve(device::TransferSink& sink, std::uint32_t recorded_id) {
  const auto start = Clock::now();
  std::optional<std::uint64_t> first_ns;
  for (auto next = reader.next(); next && *next; next = reader.next()) {
    if (!first_ns) first_ns = (*next)->time_ns;
    if (speed > 0 && !wait_until(start + due_after(*first_ns, (*next)->time_ns, speed))) return;
    if (!hand_over(sink, **next, recorded_id)) return;
    const auto* mark = std::get_if<StreamMark>(&(*next)->what);
    if (mark != nullptr && *mark == StreamMark::gone) return lose(sink);
    if (mark != nullptr) break;
  }
  end();
}

/// @return false where the stream is to stop
bool ReplayTransport::State::hand_over(device::TransferSink& sink, const Recorded& recorded,
                                       std::uint32_t recorded_id) {
  const auto* transfer = std::get_if<RecordedTransfer>(&recorded.what);
  const auto* event = std::get_if<RecordedEvent>(&recorded.what);
  {
    const std::lock_guard lock(mutex);
    if (stopping || !probe.session_id()) return false;
    if (transfer != nullptr) probe.adopt(transfer->bytes, recorded_id);
    if (event != nullptr) probe.adopt_event(event->bytes, recorded_id);
  }
  if (transfer != nullptr) sink.on_transfer(transfer->bytes);
  if (event != nullptr) sink.on_event(event->bytes);
  return true;
}

/// @return false where the stream is to stop
bool ReplayTransport::State::wait_until(Clock::time_point due) {
  std::unique_lock lock(mutex);
  return !changed.wait_until(lock, due, [&] { return stopping; });
}

void ReplayTransport::State::lose(device::TransferSink& sink) {
  {
    const std::lock_guard lock(mutex);
    lost = true;
  }
  sink.on_gone();
}

void ReplayTransport::State::end() {
  const std::lock_guard lock(mutex);
  probe.end();
}

// ---- the transport

Result<std::unique_ptr<ReplayTransport>> ReplayTransport::open(const std::filesystem::path& path, double speed) {
  assert(speed >= 0);
  auto index = RecordingIndex::of(path);
  if (!index) return tl::unexpected<Error>(index.error());
  auto reader = RecordingReader::open(path);
  if (!reader) return tl::unexpected<Error>(reader.error());
  return std::unique_ptr<ReplayTransport>(
      new ReplayTransport(std::make_unique<State>(std::move(*index), std::move(*reader), speed)));
}

ReplayTransport::ReplayTransport(std::unique_ptr<State> state) : state_(std::move(state)) {}

ReplayTransport::~ReplayTransport() {
  assert(!state_->event_thread.joinable());
}

const RecordingFacts& ReplayTransport::facts() const {
  return state_->facts;
}

bool ReplayTransport::more() const {
  const std::lock_guard lock(state_->mutex);
  return state_->to_come != 0;
}

Result<std::size_t> ReplayTransport::control(std::span<const std::byte> request, std::span<std::byte> reply,
                                             std::chrono::milliseconds) {
  const std::lock_guard lock(state_->mutex);
  if (state_->lost) return gone();
  const std::size_t size = state_->probe.answer(request, reply);
  state_->changed.notify_all();  // a session may have begun
  return size;
}

Result<void> ReplayTransport::start_stream(device::TransferSink& sink, std::size_t) {
  assert(!state_->event_thread.joinable());
  const std::lock_guard lock(state_->mutex);
  if (state_->lost) return gone();
  state_->stopping = false;
  state_->event_thread = std::jthread([state = state_.get(), &sink] { state->play(sink); });
  return {};
}

void ReplayTransport::stop_stream() {
  if (!state_->event_thread.joinable()) return;
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
    state_->changed.notify_all();
  }
  state_->event_thread.join();
}

Result<void> ReplayTransport::reopen() {
  const std::lock_guard lock(state_->mutex);
  state_->lost = false;
  return {};
}

}  // namespace sonoloft::record
