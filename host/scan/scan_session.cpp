#include "host/scan/scan_session.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "host/scan/mesh_maker.h"
#include "host/scan/pace.h"
#include "host/scan/pose_alignment.h"

namespace sonoloft {
namespace {

using Clock = std::chrono::steady_clock;
using device::DeliveredSlice;

constexpr std::size_t kMostEvents = 256;  // that wait for a callback

thread_local const void* reconstructing = nullptr;  // the scan whose callbacks this thread calls

ScanEventKind scan_kind(device::EventKind kind) {
  switch (kind) {
    case device::EventKind::disconnected:
      return ScanEventKind::disconnected;
    case device::EventKind::slices_dropped:
      return ScanEventKind::slices_dropped;
    case device::EventKind::callback_threw:
      return ScanEventKind::callback_threw;
    case device::EventKind::device_fault:
      return ScanEventKind::device_fault;
    case device::EventKind::end_of_data:
      return ScanEventKind::end_of_data;
    case device::EventKind::button:
      return ScanEventKind::button;
  }
  return ScanEventKind::device_fault;
}

void count(const std::vector<SliceReport>& slices, SliceCounts& counts) {
  for (const SliceReport& slice : slices) {
    switch (slice.fate) {
      case SliceFate::inserted:
        ++counts.inserted;
        break;
      case SliceFate::explained:
        ++counts.explained;
        break;
      case SliceFate::merged:
        ++counts.merged;
        break;
      case SliceFate::refused:
        ++counts.refused;
        break;
    }
  }
}

}  // namespace

struct ScanSession::State : std::enable_shared_from_this<State> {
  State(const ScanOptions& scan_options, std::unique_ptr<device::Session> session, MeshMaker mesh_maker)
      : options(scan_options),
        device(std::move(session)),
        maker(std::move(mesh_maker)),
        field_device(maker.field_device()) {}

  const ScanOptions options;
  const std::unique_ptr<device::Session> device;
  std::mutex maker_mutex;  ///< guards the next; never held during a callback
  MeshMaker maker;
  Pace pace;  ///< the reconstruction thread's
  struct Finish {
    Detail detail = Detail::full;
    Slopes slopes = Slopes::settled;
    bool operator==(const Finish&) const = default;
  };
  Finish shown;  ///< of the last mesh made; the reconstruction thread's
  const std::string field_device;

  std::mutex life_mutex;  ///< one start or stop at a time; never taken on the reconstruction thread
  ScanCallbacks callbacks;
  std::jthread thread;

  mutable std::mutex mutex;  ///< guards what follows; never held during a callback or a call of the device
  std::condition_variable to_reconstruction, room;
  struct Waiting {
    std::deque<std::shared_ptr<const DeliveredSlice>> slices;
    std::vector<ScanEvent> events;
    bool withdrawn = false;  ///< a slice was taken back
  };
  Waiting waiting;
  SliceCounts counts;
  bool overflow_told = false;  ///< since the queue was last empty
  bool stopping = false, failed = false;

  Result<void> start(ScanCallbacks new_callbacks);
  void finish_run();
  void request_stop();
  bool on_reconstruction_thread() const { return reconstructing == this; }

  // The dispatcher's.
  std::optional<PoseAlignment> alignment;
  void take_in(std::shared_ptr<const DeliveredSlice> slice);
  void enqueue(std::shared_ptr<const DeliveredSlice> slice);
  void take_in(const device::Event& event);

  // The reconstruction thread's.
  void reconstruct();
  bool wait(Waiting& batch);
  void work_off(const Waiting& batch);
  bool show(const Waiting& batch);
  [[nodiscard]] Finish choose_finish(const Waiting& batch, const Pace::SamplesDue& due);
  Result<std::shared_ptr<MeshUpdate>> make(const Waiting& batch);
  void deliver(std::shared_ptr<MeshUpdate> update);
  template <class Callback, class Argument>
  void call(const char* name, const Callback& callback, Argument argument);
  void fail_for_good(const std::string& cause, std::size_t lost_slices);
  void tell(const ScanEvent& event);
};

// ---- any thread

Result<void> ScanSession::State::start(ScanCallbacks new_callbacks) {
  if (on_reconstruction_thread())
    return fail(ErrorCode::wrong_state, "start() was called from a callback: call it from another thread");
  const std::lock_guard life(life_mutex);
  {
    const std::lock_guard lock(mutex);
    if (failed) return fail(ErrorCode::wrong_state, "the reconstruction of this scan has failed: open a new one");
    if (thread.joinable() && !stopping) return fail(ErrorCode::wrong_state, "the scan is running: stop() it first");
  }
  finish_run();
  {
    const std::lock_guard lock(mutex);
    stopping = overflow_told = false;
    waiting = {{}, {}, waiting.withdrawn};
  }
  if (options.pose_offset) alignment.emplace(*options.pose_offset, device->calibration().image_to_probe);
  callbacks = std::move(new_callbacks);
  thread = std::jthread([self = shared_from_this()] { self->reconstruct(); });
  device::Callbacks from_device{[this](std::shared_ptr<const DeliveredSlice> slice) { take_in(std::move(slice)); },
                                [this](const device::Event& event) { take_in(event); }};
  auto started = device->start(options.stream, std::move(from_device));
  if (!started) finish_run();
  return started;
}

void ScanSession::State::finish_run() {
  request_stop();
  if (thread.joinable()) thread.join();
}

void ScanSession::State::request_stop() {
  const std::lock_guard lock(mutex);
  stopping = true;
  to_reconstruction.notify_all();
  room.notify_all();
}

// ---- the dispatcher

void ScanSession::State::take_in(std::shared_ptr<const DeliveredSlice> slice) {
  if (!alignment) return enqueue(std::move(slice));
  for (auto& ready : alignment->push(std::move(slice))) enqueue(std::move(ready));
}

void ScanSession::State::enqueue(std::shared_ptr<const DeliveredSlice> slice) {
  std::unique_lock lock(mutex);
  ++counts.delivered;
  if (options.stream.mode == device::StreamMode::lossless)
    room.wait(lock, [&] { return stopping || waiting.slices.size() < options.queue_capacity; });
  if (stopping) {
    ++counts.dropped;
    return;
  }
  if (waiting.slices.size() == options.queue_capacity) {
    waiting.slices.pop_front();
    ++counts.dropped;
    if (!std::exchange(overflow_told, true)) {
      const ScanEvent overflow = {ScanEventKind::slices_dropped,
                                  "slices come faster than the mesh follows and the oldest are dropped: do less in "
                                  "on_mesh, or choose a wider spacing"};
      waiting.events.push_back(overflow);
    }
  }
  waiting.slices.push_back(std::move(slice));
  to_reconstruction.notify_all();
}

void ScanSession::State::take_in(const device::Event& event) {
  const bool over = event.kind == device::EventKind::end_of_data || event.kind == device::EventKind::disconnected;
  if (alignment && over) {
    for (auto& slice : alignment->flush()) enqueue(std::move(slice));
  }
  std::unique_lock lock(mutex);
  // A device that never ends telling of buttons is held back, and counted, by its own session.
  if (event.button) room.wait(lock, [&] { return stopping || waiting.events.size() < kMostEvents; });
  waiting.events.push_back({scan_kind(event.kind), event.message, event.button});
  to_reconstruction.notify_all();
}

// ---- the reconstruction thread

void ScanSession::State::reconstruct() {
  reconstructing = this;
  for (Waiting batch; wait(batch); batch = {}) work_off(batch);
  device->stop();
  const std::lock_guard lock(mutex);
  const std::size_t unaligned = alignment ? alignment->waiting() : 0;
  counts.delivered += unaligned;
  counts.dropped += waiting.slices.size() + unaligned;
  waiting = {{}, {}, waiting.withdrawn};
}

/// @return false when it is over; an empty batch when slices pause and the mesh can be better
bool ScanSession::State::wait(Waiting& batch) {
  std::unique_lock lock(mutex);
  const auto something = [&] {
    return stopping || waiting.withdrawn || !waiting.slices.empty() || !waiting.events.empty();
  };
  if (shown != Finish{})
    to_reconstruction.wait_for(lock, pace.patience(), something);
  else
    to_reconstruction.wait(lock, something);
  if (stopping) return false;
  std::swap(batch, waiting);
  overflow_told = false;
  room.notify_all();
  return true;
}

void ScanSession::State::work_off(const Waiting& batch) {
  if (!show(batch)) return;
  auto made = make(batch);
  if (!made) return fail_for_good(made.error().message, batch.slices.size());
  if (*made) deliver(std::move(*made));
  for (const ScanEvent& event : batch.events) tell(event);
}

/// @return false when the scan was stopped meanwhile
bool ScanSession::State::show(const Waiting& batch) {
  for (const auto& slice : batch.slices) {
    pace.slice_arrived(slice->arrival);
    call("on_slice", callbacks.on_slice, slice);
    const std::lock_guard lock(mutex);
    if (!stopping) continue;
    counts.dropped += batch.slices.size();
    return false;
  }
  return true;
}

ScanSession::State::Finish ScanSession::State::choose_finish(const Waiting& batch, const Pace::SamplesDue& due) {
  const bool pause = batch.slices.empty() && batch.events.empty() && !batch.withdrawn;
  const bool last = std::any_of(batch.events.begin(), batch.events.end(), [](const ScanEvent& event) {
    return event.kind == ScanEventKind::end_of_data || event.kind == ScanEventKind::disconnected;
  });
  if (pause || last || options.stream.mode == device::StreamMode::lossless) return {};
  return batch.slices.empty() && !batch.withdrawn ? shown : Finish{pace.next(shown.detail, due), Slopes::streaming};
}

/// @return null when nothing changes
Result<std::shared_ptr<MeshUpdate>> ScanSession::State::make(const Waiting& batch) {
  try {
    const auto start = Clock::now();
    const std::lock_guard lock(maker_mutex);
    for (const auto& slice : batch.slices) maker.add(slice);
    const Pace::SamplesDue due = maker.samples_due();
    const Finish finish = choose_finish(batch, due);
    if (batch.slices.empty() && !batch.withdrawn && finish == shown) return nullptr;
    auto made = maker.make(finish.detail, finish.slopes);
    shown = made && (*made)->settled ? Finish{finish.detail, Slopes::settled} : finish;
    if (batch.slices.empty()) return made;
    const std::chrono::duration<double, std::milli> all = Clock::now() - start;
    pace.took(due[static_cast<std::size_t>(finish.detail)], maker.sampling_ms(), all.count() - maker.sampling_ms());
    return made;
  } catch (const std::exception& e) {
    return fail(ErrorCode::not_available, e.what());
  }
}

void ScanSession::State::deliver(std::shared_ptr<MeshUpdate> update) {
  {
    const std::lock_guard lock(mutex);
    count(update->slices, counts);
    update->counts = counts;
  }
  const auto now = Clock::now();
  for (SliceReport& slice : update->slices)
    slice.latency_ms = std::chrono::duration<double, std::milli>(now - slice.slice->arrival).count();
  call("on_mesh", callbacks.on_mesh, std::shared_ptr<const MeshUpdate>(std::move(update)));
}

/// Calls a callback, if there is one, and tells of what it throws.
template <class Callback, class Argument>
void ScanSession::State::call(const char* name, const Callback& callback, Argument argument) {
  std::string what;
  try {
    if (callback) callback(std::move(argument));
    return;
  } catch (const std::exception& e) {
    what = e.what();
  } catch (...) {
    what = "something that is no std::exception";
  }
  tell({ScanEventKind::callback_threw, std::string(name) + " threw: " + what + "; catch it there"});
}

void ScanSession::State::fail_for_good(const std::string& cause, std::size_t lost_slices) {
  tell({ScanEventKind::reconstruction_failed, "the reconstruction failed: " + cause + "; open a new scan"});
  {
    const std::lock_guard lock(mutex);
    failed = true;
    counts.dropped += lost_slices;
  }
  request_stop();
}

void ScanSession::State::tell(const ScanEvent& event) {
  {
    const std::lock_guard lock(mutex);
    if (stopping) return;  // a callback that called stop() was the last one
  }
  try {
    if (callbacks.on_event) callbacks.on_event(event);
  } catch (...) {
    // There is nobody left to tell.
  }
}

// ---- the session

ScanSession::ScanSession(std::shared_ptr<State> state) : state_(std::move(state)) {}

Result<std::unique_ptr<ScanSession>> ScanSession::open(std::unique_ptr<device::Transport> transport,
                                                       const ScanOptions& options) {
  if (options.queue_capacity == 0) return fail(ErrorCode::invalid_argument, "queue_capacity is 0: give at least 1");
  auto maker = MeshMaker::create(options.reconstructor);
  if (!maker) return tl::unexpected<Error>(maker.error());
  auto device = device::Session::open(std::move(transport));
  if (!device) return tl::unexpected<Error>(device.error());
  return std::unique_ptr<ScanSession>(
      new ScanSession(std::make_shared<State>(options, std::move(*device), std::move(*maker))));
}

ScanSession::~ScanSession() {
  if (state_->on_reconstruction_thread()) {
    state_->request_stop();
    state_->thread.detach();  // it holds the state, takes the run down and ends
  } else {
    stop();
  }
}

Result<void> ScanSession::start(ScanCallbacks callbacks) {
  const auto state = state_;  // a callback may destroy the session before this returns
  return state->start(std::move(callbacks));
}

void ScanSession::stop() {
  if (state_->on_reconstruction_thread()) return state_->request_stop();
  const std::lock_guard life(state_->life_mutex);
  state_->finish_run();
}

Result<void> ScanSession::send_blob(device::BlobKind kind, std::span<const std::byte> bytes) {
  if (state_->on_reconstruction_thread()) {
    return fail(ErrorCode::wrong_state, "send_blob() was called from a callback: call it from another thread");
  }
  const std::lock_guard life(state_->life_mutex);
  return state_->device->send_blob(kind, bytes);
}

Result<void> ScanSession::withdraw(std::uint64_t slice_id) {
  {
    const std::lock_guard lock(state_->maker_mutex);
    if (auto done = state_->maker.withdraw(slice_id); !done) return done;
  }
  const std::lock_guard lock(state_->mutex);
  state_->waiting.withdrawn = true;
  state_->to_reconstruction.notify_all();
  return {};
}

Coverage ScanSession::coverage() const {
  const std::lock_guard lock(state_->maker_mutex);
  return state_->maker.coverage();
}

Confidence ScanSession::confidence(std::span<const Eigen::Vector3f> points_mm) const {
  const std::lock_guard lock(state_->maker_mutex);
  return state_->maker.confidence(points_mm);
}

device::Ledger ScanSession::ledger() const {
  return state_->device->ledger();
}

SliceCounts ScanSession::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

const device::DeviceInfo& ScanSession::device_info() const {
  return state_->device->info();
}

const std::string& ScanSession::field_device() const {
  return state_->field_device;
}

}  // namespace sonoloft
