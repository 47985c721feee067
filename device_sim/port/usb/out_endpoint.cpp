#include "device_sim/port/usb/out_endpoint.h"

#include <algorithm>
#include <utility>

namespace sonoloft::device_sim::usb {

using protocol::PortStatus;

OutEndpoint::OutEndpoint(std::size_t max_packet, std::size_t max_message, Write write, UrbSink done)
    : max_packet_(max_packet),
      max_message_(max_message),
      write_(std::move(write)),
      done_(std::move(done)),
      thread_([this] { pump(); }) {}

OutEndpoint::~OutEndpoint() {
  const std::lock_guard lock(mutex_);
  closing_ = true;
  wake_.notify_all();
}

void OutEndpoint::submit(Urb urb) {
  const std::lock_guard lock(mutex_);
  if (gone_) return done_({urb.id, UrbStatus::gone, {}, 0});
  if (halted_) return done_({urb.id, UrbStatus::stalled, {}, 0});
  waiting_.push_back(std::move(urb));
  wake_.notify_all();
}

bool OutEndpoint::unlink(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  if (taking_ == id) {
    taking_.reset();
    return true;
  }
  return std::erase_if(waiting_, [&](const Urb& urb) { return urb.id == id; }) != 0;
}

void OutEndpoint::halt() {
  const std::lock_guard lock(mutex_);
  halted_ = true;
  for (const Urb& urb : std::exchange(waiting_, {})) done_({urb.id, UrbStatus::stalled, {}, 0});
}

void OutEndpoint::clear_halt() {
  const std::lock_guard lock(mutex_);
  halted_ = false;
  message_.clear();
}

bool OutEndpoint::halted() const {
  const std::lock_guard lock(mutex_);
  return halted_;
}

void OutEndpoint::reset() {
  const std::lock_guard lock(mutex_);
  halted_ = false;
  message_.clear();
  waiting_.clear();
  taking_.reset();
}

void OutEndpoint::pump() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return closing_ || !waiting_.empty(); });
    if (closing_) return;
    const Urb urb = std::move(waiting_.front());
    waiting_.pop_front();
    taking_ = urb.id;
    const UrbStatus status = take(lock, urb);
    gone_ |= status == UrbStatus::gone;
    if (std::exchange(taking_, {}) == urb.id) {
      done_({urb.id, status, {}, status == UrbStatus::ok ? urb.data.size() : 0});
    }
  }
}

UrbStatus OutEndpoint::take(std::unique_lock<std::mutex>& lock, const Urb& urb) {
  // One byte more than a message may have tells that it is too long; what follows of it need not be kept.
  const std::size_t room = max_message_ + 1 - message_.size();
  const auto kept = std::span(urb.data).first(std::min(room, urb.data.size()));
  message_.insert(message_.end(), kept.begin(), kept.end());
  const bool ended = urb.data.empty() || urb.data.size() % max_packet_ != 0;
  if (!ended) return UrbStatus::ok;
  const auto message = std::exchange(message_, {});
  if (message.size() > max_message_) return UrbStatus::ok;
  lock.unlock();
  const PortStatus status = write_(message).status;
  lock.lock();
  return status == PortStatus::gone ? UrbStatus::gone : UrbStatus::ok;
}

}  // namespace sonoloft::device_sim::usb
