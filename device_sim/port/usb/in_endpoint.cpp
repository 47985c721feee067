#include "device_sim/port/usb/in_endpoint.h"

#include <algorithm>
#include <utility>

namespace sonoloft::device_sim::usb {

using protocol::PortStatus;

InEndpoint::InEndpoint(std::size_t max_packet, std::size_t max_message, Read read, UrbSink done)
    : max_packet_(max_packet), read_(std::move(read)), done_(std::move(done)), buffer_(max_message), thread_([this] {
        pump();
      }) {}

InEndpoint::~InEndpoint() {
  const std::lock_guard lock(mutex_);
  closing_ = true;
  waiting_.clear();
  wake_.notify_all();
}

void InEndpoint::submit(std::uint64_t id, std::size_t room) {
  const std::lock_guard lock(mutex_);
  if (gone_) return done_({id, UrbStatus::gone, {}, 0});
  if (halted_) return done_({id, UrbStatus::stalled, {}, 0});
  waiting_.push_back({id, room});
  wake_.notify_all();
}

bool InEndpoint::unlink(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  return std::erase_if(waiting_, [&](const Waiting& urb) { return urb.id == id; }) != 0;
}

void InEndpoint::halt() {
  const std::lock_guard lock(mutex_);
  halted_ = true;
  complete_all(UrbStatus::stalled);
}

void InEndpoint::clear_halt() {
  const std::lock_guard lock(mutex_);
  halted_ = false;
  message_.reset();
}

bool InEndpoint::halted() const {
  const std::lock_guard lock(mutex_);
  return halted_;
}

void InEndpoint::reset() {
  const std::lock_guard lock(mutex_);
  ++resets_;
  halted_ = false;
  message_.reset();
  waiting_.clear();
}

void InEndpoint::pump() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return closing_ || !waiting_.empty(); });
    if (closing_) return;
    if (!message_) fetch(lock);
    if (!waiting_.empty() && message_) hand_over();
  }
}

void InEndpoint::fetch(std::unique_lock<std::mutex>& lock) {
  const auto resets = resets_;
  lock.unlock();
  const auto got = read_(buffer_);
  lock.lock();
  if (got.status == PortStatus::ok && resets == resets_) message_ = std::span<const std::byte>(buffer_).first(got.size);
  if (got.status == PortStatus::halted) {
    halted_ = true;
    complete_all(UrbStatus::stalled);
  }
  if (got.status == PortStatus::gone) {
    gone_ = true;
    complete_all(UrbStatus::gone);
  }
}

void InEndpoint::hand_over() {
  const Waiting urb = waiting_.front();
  waiting_.pop_front();
  // Whole packets fit, or the last one is too much for the room: then the host loses what it cannot take.
  const bool overflow = message_->size() > urb.room && urb.room % max_packet_ != 0;
  const auto part = message_->first(std::min(message_->size(), urb.room));
  const auto rest = message_->subspan(part.size());
  message_ = overflow || rest.empty() ? std::nullopt : std::optional(rest);
  done_({urb.id, overflow ? UrbStatus::overflow : UrbStatus::ok, part, part.size()});
}

void InEndpoint::complete_all(UrbStatus status) {
  for (const Waiting& urb : std::exchange(waiting_, {})) done_({urb.id, status, {}, 0});
}

}  // namespace sonoloft::device_sim::usb
