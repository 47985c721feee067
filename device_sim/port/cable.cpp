#include "device_sim/port/cable.h"

#include <algorithm>

namespace sonoloft::device_sim {

using protocol::PortStatus;
using protocol::PortTransfer;

namespace {

constexpr std::chrono::milliseconds kTickPeriod{50};  // of the firmware's watchdog

std::uint64_t now_ns() {
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(Cable::Clock::now().time_since_epoch()).count());
}

}  // namespace

PortTransfer Cable::control(std::span<const std::byte> request, std::span<std::byte> reply) {
  const std::lock_guard lock(mutex_);
  if (gone_) return {PortStatus::gone, 0};
  const std::size_t size = firmware_.handle_request(request, reply, now_ns());
  to_acquisition_.notify_all();
  to_host_.notify_all();  // the watchdog may have had a look
  return {PortStatus::ok, size};
}

PortTransfer Cable::read(std::span<std::byte> record, std::uint32_t timeout_ms) {
  Lock lock(mutex_);
  const PortStatus status = wait_for_host(lock, timeout_ms, &Firmware::ring_empty);
  if (status != PortStatus::ok) return {status, 0};
  to_acquisition_.notify_all();
  return {status, firmware_.take_record(record)};
}

PortTransfer Cable::read_event(std::span<std::byte> event, std::uint32_t timeout_ms) {
  Lock lock(mutex_);
  const PortStatus status = wait_for_host(lock, timeout_ms, &Firmware::events_empty);
  return {status, status == PortStatus::ok ? firmware_.take_event(event) : 0};
}

// ok: there is something to take.
PortStatus Cable::wait_for_host(Lock& lock, std::uint32_t timeout_ms, bool (Firmware::*nothing)() const) {
  const auto ended = [&] { return gone_ || reads_cancelled_ || !(firmware_.*nothing)(); };
  const bool in_time = to_host_.wait_for(lock, std::chrono::milliseconds(timeout_ms), ended);
  if (gone_) return PortStatus::gone;
  if (reads_cancelled_) return PortStatus::cancelled;
  return in_time ? PortStatus::ok : PortStatus::timed_out;
}

PortTransfer Cable::write_block(std::span<const std::byte> block) {
  const Lock lock(mutex_);
  if (gone_) return {PortStatus::gone, 0};
  firmware_.take_block(block);
  return {PortStatus::ok, block.size()};
}

void Cable::cancel_reads() {
  const std::lock_guard lock(mutex_);
  reads_cancelled_ = true;
  to_host_.notify_all();
}

void Cable::allow_reads() {
  const std::lock_guard lock(mutex_);
  reads_cancelled_ = false;
}

bool Cable::may_acquire(std::optional<Clock::time_point> due) const {
  if (firmware_.state() != protocol::DeviceState::streaming) return false;
  if (due) return Clock::now() >= *due;
  return firmware_.mode() == protocol::StreamMode::live || !firmware_.ring_full();
}

bool Cable::wait_to_acquire(std::optional<Clock::time_point> due) {
  std::unique_lock lock(mutex_);
  while (!gone_ && !shut_down_ && !may_acquire(due)) {
    const auto next_tick = Clock::now() + kTickPeriod;
    const bool sleep_to_due = due && *due > Clock::now();
    to_acquisition_.wait_until(lock, sleep_to_due ? std::min(*due, next_tick) : next_tick);
    firmware_.tick(now_ns());
    if (!firmware_.events_empty()) to_host_.notify_all();
  }
  return !gone_ && !shut_down_;
}

void Cable::acquire(const AcquiredSlice& slice) {
  const std::lock_guard lock(mutex_);
  firmware_.acquire(slice, now_ns());
  to_host_.notify_all();
}

void Cable::end_of_source() {
  const std::lock_guard lock(mutex_);
  firmware_.end_of_source(now_ns());
  to_host_.notify_all();
}

void Cable::button(std::uint16_t number, bool pressed) {
  const std::lock_guard lock(mutex_);
  firmware_.button(number, pressed, now_ns());
  to_host_.notify_all();
}

void Cable::shut_down() {
  const std::lock_guard lock(mutex_);
  shut_down_ = true;
  to_acquisition_.notify_all();
}

void Cable::unplug() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  to_host_.notify_all();
  to_acquisition_.notify_all();
}

protocol::StatsReply Cable::stats() {
  const std::lock_guard lock(mutex_);
  return firmware_.stats();
}

}  // namespace sonoloft::device_sim
