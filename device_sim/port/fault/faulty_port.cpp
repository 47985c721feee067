#include "device_sim/port/fault/faulty_port.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "protocol/command.h"
#include "protocol/record.h"

namespace sonoloft::device_sim {

using protocol::PortStatus;
using protocol::PortTransfer;

namespace {

constexpr std::chrono::milliseconds kReplyPatience{20};  // as long as a bus waits for a reply that never comes

std::uint32_t session_of(std::span<const std::byte> record) {
  protocol::RecordHeader header;
  return protocol::read_payload(record, header) ? header.session_id : 0;
}

}  // namespace

void FaultyPort::set_plan(const FaultPlan& plan) {
  const std::lock_guard lock(mutex_);
  plan_ = plan;
}

bool FaultyPort::dead() const {
  const std::lock_guard lock(mutex_);
  return gone_ || mute_ || deaf_;
}

void FaultyPort::become(bool& state) {
  const std::lock_guard lock(mutex_);
  state = true;
  changed_.notify_all();
}

// ---- requests

PortTransfer FaultyPort::control(std::span<const std::byte> request, std::span<std::byte> reply) {
  Lock lock(mutex_);
  if (gone_) return {PortStatus::gone, 0};
  if (deaf_) {
    changed_.wait_for(lock, kReplyPatience, [&] { return gone_; });
    return {PortStatus::timed_out, 0};
  }
  const FaultKind kind = plan_.strikes_request() ? plan_.kind() : FaultKind::none;
  if (kind != FaultKind::none) ++counts_.requests;
  if (kind == FaultKind::lose_request) return {PortStatus::timed_out, 0};
  if (kind == FaultKind::disconnect_request) {
    gone_ = true;
    changed_.notify_all();
    const std::size_t arrived = plan_.offset(request.size());
    lock.unlock();
    (void)port_.control(request.first(arrived), reply);
    return {PortStatus::gone, 0};
  }
  lock.unlock();
  PortTransfer done = port_.control(request, reply);
  lock.lock();
  if (kind == FaultKind::lose_reply) return {PortStatus::timed_out, 0};
  if (kind == FaultKind::disconnect_reply) gone_ = true;
  if (kind == FaultKind::cut_reply || kind == FaultKind::disconnect_reply) done.size = plan_.offset(done.size);
  changed_.notify_all();
  return done;
}

// ---- records

PortTransfer FaultyPort::read(std::span<std::byte> record, std::uint32_t timeout_ms) {
  if (const auto answer = answer_for_port(record, timeout_ms)) return *answer;
  const PortTransfer done = port_.read(record, timeout_ms);
  if (done.status != PortStatus::ok) return done;
  Lock lock(mutex_);
  remember(record.first(done.size));
  const bool struck = plan_.strikes_record();
  lock.unlock();
  return struck ? strike(record, done.size, timeout_ms) : done;
}

// What a fault before this one has left to be read.
std::optional<PortTransfer> FaultyPort::answer_for_port(std::span<std::byte> record, std::uint32_t timeout_ms) {
  Lock lock(mutex_);
  if (gone_) return PortTransfer{PortStatus::gone, 0};
  if (mute_ || deaf_) return wait_in_silence(lock, timeout_ms);
  if (halted_) return PortTransfer{PortStatus::halted, 0};
  if (next_.empty()) return std::nullopt;
  const std::size_t size = next_.size();
  std::copy(next_.begin(), next_.end(), record.begin());
  next_.clear();
  return PortTransfer{PortStatus::ok, size};
}

PortTransfer FaultyPort::wait_in_silence(Lock& lock, std::uint32_t timeout_ms) {
  changed_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [&] { return gone_ || cancelled_; });
  if (gone_) return {PortStatus::gone, 0};
  return {cancelled_ ? PortStatus::cancelled : PortStatus::timed_out, 0};
}

void FaultyPort::remember(std::span<const std::byte> record) {
  if (plan_.kind() != FaultKind::stale && plan_.kind() != FaultKind::none) return;
  if (session_of(record) != session_of(last_)) stale_ = last_;
  last_.assign(record.begin(), record.end());
}

PortTransfer FaultyPort::strike(std::span<std::byte> record, std::size_t size, std::uint32_t timeout_ms) {
  const auto sent = record.first(size);
  switch (plan_.kind()) {
    case FaultKind::drop:
      ++counts_.lost;
      return read(record, timeout_ms);
    case FaultKind::duplicate:
      ++counts_.repeated;
      next_.assign(sent.begin(), sent.end());
      break;
    case FaultKind::swap:
      return swap(record, size, timeout_ms);
    case FaultKind::stale:
      if (!stale_.empty()) ++counts_.repeated;
      next_ = stale_;
      break;
    case FaultKind::truncate:
      ++counts_.altered;
      return {PortStatus::ok, plan_.offset(size)};
    case FaultKind::extend:
      ++counts_.altered;
      return {PortStatus::ok, extend(record, size)};
    case FaultKind::flip:
      ++counts_.altered;
      flip(sent);
      break;
    case FaultKind::delay:
      hold(std::chrono::milliseconds(plan_.amount(1, 5)));
      break;
    case FaultKind::stall:
      hold(std::chrono::milliseconds(plan_.amount(50, 300)));
      break;
    case FaultKind::nak_for_ever:
      ++counts_.lost;
      become(mute_);
      return read(record, timeout_ms);
    case FaultKind::halt:
      ++counts_.lost;
      become(halted_);
      return {PortStatus::halted, 0};
    case FaultKind::disconnect:
      ++counts_.altered;
      become(gone_);
      return {PortStatus::ok, plan_.offset(size)};
    case FaultKind::freeze:
    case FaultKind::host_death:
      ++counts_.lost;
      become(deaf_);
      return read(record, timeout_ms);
    case FaultKind::reset:
      ++counts_.altered;
      restart_device();
      return {PortStatus::ok, plan_.offset(size)};
    default:
      break;
  }
  return {PortStatus::ok, size};
}

PortTransfer FaultyPort::swap(std::span<std::byte> record, std::size_t size, std::uint32_t timeout_ms) {
  std::vector<std::byte> first(record.begin(), record.begin() + static_cast<std::ptrdiff_t>(size));
  const PortTransfer second = port_.read(record, timeout_ms);
  if (second.status != PortStatus::ok) {
    std::copy(first.begin(), first.end(), record.begin());
    return {PortStatus::ok, size};
  }
  ++counts_.lost;
  ++counts_.repeated;
  next_ = std::move(first);
  return second;
}

std::size_t FaultyPort::extend(std::span<std::byte> record, std::size_t size) {
  const auto room = static_cast<std::uint32_t>(std::min<std::size_t>(record.size() - size, 256));
  const std::size_t longer = size + plan_.amount(1, room);
  for (std::byte& b : record.subspan(size, longer - size)) b = static_cast<std::byte>(plan_.amount(0, 255));
  return longer;
}

void FaultyPort::flip(std::span<std::byte> record) {
  for (std::uint32_t left = plan_.amount(1, 4), at = 0; left > 0; --left) {  // each in a byte of its own
    at += plan_.amount(1, static_cast<std::uint32_t>(record.size()) / 5);
    record[at] ^= static_cast<std::byte>(1u << plan_.amount(0, 7));
  }
}

void FaultyPort::hold(std::chrono::milliseconds duration) {
  ++counts_.held;
  Lock lock(mutex_);
  changed_.wait_for(lock, duration, [&] { return gone_ || cancelled_; });
}

void FaultyPort::restart_device() {
  std::array<std::byte, sizeof(protocol::RequestHeader)> request;
  std::array<std::byte, protocol::kMaxRequestLen> reply;
  const std::size_t size = protocol::encode_request(protocol::Command::reset, 0, {}, request);
  (void)port_.control(std::span(request).first(size), reply);
}

// ---- events and blocks

PortTransfer FaultyPort::read_event(std::span<std::byte> event, std::uint32_t timeout_ms) {
  Lock lock(mutex_);
  if (gone_) return {PortStatus::gone, 0};
  if (mute_ || deaf_) return wait_in_silence(lock, timeout_ms);
  lock.unlock();
  return port_.read_event(event, timeout_ms);
}

PortTransfer FaultyPort::write_block(std::span<const std::byte> block) {
  Lock lock(mutex_);
  if (gone_) return {PortStatus::gone, 0};
  if (deaf_) return {PortStatus::timed_out, 0};
  if (!plan_.strikes_record()) {
    lock.unlock();
    return port_.write_block(block);
  }
  std::vector<std::byte> altered(block.begin(), block.end());
  switch (plan_.kind()) {
    case FaultKind::drop:
      ++counts_.lost;
      return {PortStatus::ok, block.size()};
    case FaultKind::duplicate:
      ++counts_.repeated;
      lock.unlock();
      (void)port_.write_block(block);
      return port_.write_block(block);
    case FaultKind::truncate:
      ++counts_.altered;
      altered.resize(plan_.offset(block.size()));
      break;
    case FaultKind::flip:
      ++counts_.altered;
      flip(altered);
      break;
    default:
      break;
  }
  lock.unlock();
  return port_.write_block(altered);
}

// ---- the ends of it

void FaultyPort::cancel_reads() {
  become(cancelled_);
  port_.cancel_reads();
}

void FaultyPort::allow_reads() {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = false;
    next_.clear();
  }
  port_.allow_reads();
}

void FaultyPort::clear_halt() {
  {
    const std::lock_guard lock(mutex_);
    halted_ = false;
  }
  port_.clear_halt();
}

}  // namespace sonoloft::device_sim
