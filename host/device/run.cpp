#include "host/device/run.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <exception>
#include <string>
#include <utility>

namespace sonoloft::device {

using protocol::Command;
using protocol::DeviceFault;
using protocol::DeviceState;
using protocol::Reject;

namespace {

constexpr std::chrono::milliseconds kBeatPeriod{250};  // the device gives up after 1500
constexpr std::chrono::milliseconds kBeatPatience{500};
constexpr std::chrono::milliseconds kStopPatience{300};
constexpr int kQuietBeats = 4;
constexpr std::size_t kMostEvents = 256;  // that wait for a callback; nobody presses buttons so fast
// A stream that stands still is restarted, then the device reset, then given up: this long after each other. One that
// answers no requests either is only given up; the next start resets it.
constexpr std::chrono::seconds kStillPatience{1};
constexpr int kCures = 2;

thread_local const Run* dispatching = nullptr;  // the run whose callbacks this thread calls

std::string fault_text(const protocol::HeartbeatReply& beat) {
  switch (static_cast<DeviceFault>(beat.fault)) {
    case DeviceFault::ring_full:
      return "the device's ring ran full in lossless mode and acquisition ended: do less in the callback, or go live";
    case DeviceFault::watchdog:
      return "the device heard nothing from the host for too long and stopped: start again";
    case DeviceFault::none:
      break;
  }
  return "the device was stopped by somebody else: close other programs that use it, then start again";
}

}  // namespace

Run::Run(Transport& transport, Requester& requester, Plan plan)
    : transport_(transport),
      requester_(requester),
      plan_(std::move(plan)),
      acceptor_(plan_.agreement),
      clock_(requester, plan_.start.session_id),
      queue_(plan_.queue_capacity) {}

Run::~Run() {
  assert(!keeper_.joinable() && !dispatcher_.joinable());
}

Result<void> Run::begin() {
  clock_.burst([](std::chrono::microseconds) { return true; });  // so that the first slice's time is mapped already
  if (auto started = transport_.start_stream(*this, plan_.agreement.max_record); !started) return started;
  if (auto started = requester_.tell(Command::start, protocol::bytes_of(plan_.start)); !started) {
    (void)requester_.tell(Command::stop, {}, kStopPatience);  // a START whose reply got lost may have worked
    request_stop();
    transport_.stop_stream();
    return started;
  }
  dispatcher_ = std::jthread([this] { dispatch(); });
  next_beat_ = std::chrono::steady_clock::now() + kBeatPeriod;
  next_cure_ = next_beat_ + kStillPatience;
  keeper_ = std::jthread([this] { keep(); });
  return {};
}

void Run::request_stop() {
  const std::lock_guard lock(mutex_);
  stopping_ = true;
  to_dispatcher_.notify_all();
  to_keeper_.notify_all();
  room_.notify_all();
}

void Run::join() {
  keeper_.join();
}

bool Run::on_dispatcher() const {
  return dispatching == this;
}

bool Run::lost() const {
  const std::lock_guard lock(mutex_);
  return gone_;
}

bool Run::stopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

Statistics Run::statistics() const {
  const auto clock = clock_.figures();
  const std::lock_guard lock(mutex_);
  return {books_.ledger(), rejected_, events_lost_, clock};
}

// ---- the event thread

void Run::on_transfer(std::span<const std::byte> transfer) {
  const auto arrival = std::chrono::steady_clock::now();
  protocol::AcceptedSlice accepted;
  Reject reason = acceptor_.accept(transfer, accepted);
  // The calibration cannot change while a device streams, so another one is nonsense.
  if (reason == Reject::none && accepted.slice.calibration_id != plan_.calibration.id) reason = Reject::meaning;
  if (reason != Reject::none) return count_reject(reason);
  auto slice =
      std::make_shared<DeliveredSlice>(to_delivered(accepted.slice, accepted.header.seq, plan_.calibration, arrival));
  slice->host_time = clock_.at(slice->slice.time);
  enqueue(std::move(slice), accepted.header.device_dropped_total);
}

void Run::count_reject(Reject reason) {
  const std::lock_guard lock(mutex_);
  ++rejected_[static_cast<std::size_t>(reason)];
  switch (reason) {
    case Reject::header_crc:
    case Reject::payload_crc:
      books_.receive_crc_bad();
      break;
    case Reject::session:
      books_.receive_foreign();
      break;
    default:
      books_.receive_malformed();
      break;
  }
}

void Run::enqueue(std::shared_ptr<const DeliveredSlice> slice, std::uint32_t device_dropped_total) {
  std::unique_lock lock(mutex_);
  if (plan_.start.mode == static_cast<std::uint16_t>(protocol::StreamMode::lossless)) {
    room_.wait(lock, [&] { return stopping_ || !queue_.full(); });
  }
  if (!books_.receive(slice->slice.id, device_dropped_total)) return;
  if (queue_.push(std::move(slice))) books_.drop_on_host(1);
  to_dispatcher_.notify_all();
}

// What the device says of its state is news, not truth: the keeper asks. So nothing hangs on an event that got lost.
void Run::on_event(std::span<const std::byte> bytes) {
  const auto event = protocol::parse_event(bytes);
  if (!event || event->session_id != plan_.start.session_id) return;
  const bool button = static_cast<protocol::EventKind>(event->kind) == protocol::EventKind::button;
  {
    const std::lock_guard lock(mutex_);
    if (event->seq < next_event_) return;
    events_lost_ += event->seq - next_event_;
    next_event_ = event->seq + 1;
    beat_early_ |= !button;
    to_keeper_.notify_all();
  }
  if (button) report_button(*event);
}

void Run::report_button(const protocol::EventMessage& event) {
  Button button{event.number, event.value != 0, std::chrono::nanoseconds(event.t_device_ns), {}};
  button.host_time = clock_.at(button.time);
  const std::string what = button.pressed ? " was pressed" : " was let go";
  const std::lock_guard lock(mutex_);
  if (queue_.events() >= kMostEvents) {
    ++events_lost_;
    return;
  }
  queue_.push(Event{EventKind::button, "button " + std::to_string(button.number) + " of the probe" + what, button});
  to_dispatcher_.notify_all();
}

void Run::on_gone() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  to_keeper_.notify_all();
}

// ---- the dispatcher

void Run::dispatch() {
  dispatching = this;
  std::unique_lock lock(mutex_);
  while (true) {
    to_dispatcher_.wait(lock, [&] { return stopping_ || !queue_.empty(); });
    if (stopping_) return;
    const auto item = queue_.pop();
    if (item->index() == 0) books_.deliver();
    room_.notify_all();
    lock.unlock();
    call(*item);
    lock.lock();
  }
}

void Run::call(const DeliveryQueue::Item& item) {
  std::string what;
  try {
    if (const auto* event = std::get_if<Event>(&item)) {
      if (plan_.callbacks.on_event) plan_.callbacks.on_event(*event);
    } else if (plan_.callbacks.on_slice) {
      plan_.callbacks.on_slice(std::get<0>(item));
    }
    return;
  } catch (const std::exception& e) {
    what = e.what();
  } catch (...) {
    what = "something that is no std::exception";
  }
  // A callback that called stop() before it threw was the last one.
  if (!stopping()) call_event({EventKind::callback_threw, "a callback threw: " + what + "; catch it there"});
}

void Run::call_event(const Event& event) {
  try {
    if (plan_.callbacks.on_event) plan_.callbacks.on_event(event);
  } catch (...) {
    // There is nobody left to tell.
  }
}

// ---- the keeper

void Run::keep() {
  while (wait_for_work()) {
    if (std::chrono::steady_clock::now() >= next_beat_) beat();
    if (std::chrono::steady_clock::now() >= clock_.next_burst()) synchronise();
  }
  {
    std::unique_lock lock(mutex_);
    if (gone_ && !stopping_) {
      lock.unlock();
      transport_.stop_stream();  // so that the last slices come before the news
      report({EventKind::disconnected, stalled_ ? "the device's stream stands still: start again, which resets it"
                                                : "the device went away: plug it in and start again"});
      lock.lock();
      to_keeper_.wait(lock, [&] { return stopping_; });
    }
  }
  take_down();
}

bool Run::wait_for_work() {
  std::unique_lock lock(mutex_);
  to_keeper_.wait_until(lock, std::min(next_beat_, clock_.next_burst()),
                        [&] { return stopping_ || gone_ || beat_early_; });
  if (std::exchange(beat_early_, false)) next_beat_ = std::chrono::steady_clock::now();
  return !stopping_ && !gone_;
}

void Run::synchronise() {
  clock_.burst([this](std::chrono::microseconds pause) {
    std::unique_lock lock(mutex_);
    return !to_keeper_.wait_for(lock, pause, [&] { return stopping_ || gone_; });
  });
}

void Run::beat() {
  next_beat_ = std::chrono::steady_clock::now() + kBeatPeriod;
  const auto reply = requester_.ask<protocol::HeartbeatReply>(Command::heartbeat, {}, kBeatPatience);
  if (reply) {
    look_for_fault(*reply);
    look_for_end(*reply);
  } else if (reply.error().code == ErrorCode::transport_closed) {
    return on_gone();
  }  // any other failure: the next beat may fare better, and the device says so itself when it stops
  look_for_stall(reply);
}

void Run::look_for_fault(const protocol::HeartbeatReply& beat) {
  if (fault_told_ || static_cast<DeviceState>(beat.state) == DeviceState::streaming) return;
  fault_told_ = true;
  report({EventKind::device_fault, fault_text(beat)});
}

void Run::look_for_end(const protocol::HeartbeatReply& beat) {
  if (end_told_ || (beat.flags & protocol::kStatsSourceEnded) == 0 || beat.ring_used != 0) return;
  const auto stats = requester_.ask<protocol::StatsReply>(Command::get_stats, {}, kBeatPatience);
  if (!stats) return;
  {
    const std::lock_guard lock(mutex_);
    // A record that got lost at the very end never comes: then a while without news is enough.
    const bool quiet = books_.seen() == seen_at_last_beat_ && queue_.empty();
    quiet_beats_ = quiet ? quiet_beats_ + 1 : 0;
    seen_at_last_beat_ = books_.seen();
    if (books_.seen() < stats->next_seq && quiet_beats_ < kQuietBeats) return;
  }
  end_told_ = true;
  report({EventKind::end_of_data, "the device has nothing more in this session: stop"});
}

void Run::look_for_stall(const Result<protocol::HeartbeatReply>& beat) {
  using Clock = std::chrono::steady_clock;
  {
    const std::lock_guard lock(mutex_);
    const bool held_back =
        plan_.start.mode == static_cast<std::uint16_t>(protocol::StreamMode::lossless) && queue_.full();
    const bool has_records = !beat || beat->ring_used != 0;
    const bool still = has_records && books_.seen() == seen_at_last_look_ && !held_back;
    seen_at_last_look_ = books_.seen();
    if (!still) {
      cures_ = 0;
      next_cure_ = Clock::now() + kStillPatience;
    }
    if (Clock::now() < next_cure_) return;
    if (cures_ == kCures) gone_ = stalled_ = true;
    if (gone_) return;
  }
  if (beat && cures_ == 0) transport_.restart_stream();
  if (beat && cures_ == 1) transport_.reset_stream();
  ++cures_;
  next_cure_ = Clock::now() + kStillPatience;
}

void Run::report(Event event) {
  const std::lock_guard lock(mutex_);
  queue_.push(std::move(event));
  to_dispatcher_.notify_all();
}

void Run::take_down() {
  bool gone;
  {
    const std::lock_guard lock(mutex_);
    gone = gone_ && !stalled_;
  }
  if (!gone) (void)requester_.tell(Command::stop, {}, kStopPatience);  // its failure shows in the books
  transport_.stop_stream();
  dispatcher_.join();
  std::optional<protocol::StatsReply> stats;
  if (!gone) {
    const auto reply = requester_.ask<protocol::StatsReply>(Command::get_stats, {}, kStopPatience);
    if (reply && reply->session_id == plan_.start.session_id) stats = *reply;
  }
  const std::lock_guard lock(mutex_);
  books_.drop_on_host(queue_.slices());
  books_.close(stats);
}

}  // namespace sonoloft::device
