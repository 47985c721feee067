#pragma once
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

#include "device_sim/port/loopback_device.h"
#include "host/device/loopback/loopback_transport.h"
#include "host/device/session.h"
#include "tests/support/wire/wire_slices.h"

namespace sonoloft::test {

/// ImageToProbe of the tests: 0.2 x 0.25 mm pixels, turned and shifted.
inline protocol::CalibrationMessage test_calibration() {
  return {kTestCalibrationId, 0, {0, -0.25, 0, 5, 0.2, 0, 0, -40, 0, 0, 1, 12}};
}

/// A source of `count` slices, make_wire_slice(0), make_wire_slice(1), ...
inline device_sim::SliceSource numbered_slices(std::uint32_t count) {
  auto current = std::make_shared<OwnedWireSlice>();
  return [current, count, next = std::uint32_t{0}]() mutable -> const device_sim::AcquiredSlice* {
    if (next == count) return nullptr;
    *current = make_wire_slice(next++);
    return &current->view();
  };
}

inline device_sim::LoopbackOptions loopback_options(std::size_t ring_records = 16) {
  device_sim::LoopbackOptions options;
  options.firmware = {kTestLimits, {"LOOP-1"}, test_calibration()};
  options.ring_records = ring_records;
  return options;
}

inline std::unique_ptr<device::Session> open_session(protocol::Port& port) {
  auto session = device::Session::open(std::make_unique<device::LoopbackTransport>(port));
  if (!session) FAIL(session.error().message);
  return std::move(*session);
}

/// Everything that a run called back with, and a way to wait for it.
class Inbox {
 public:
  device::Callbacks callbacks() {
    return {[this](auto slice) { add(std::move(slice)); }, [this](const device::Event& event) { add(event); }};
  }
  void add(std::shared_ptr<const device::DeliveredSlice> slice) {
    const std::lock_guard lock(mutex_);
    slices_.push_back(std::move(slice));
    changed_.notify_all();
  }
  void add(const device::Event& event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
    changed_.notify_all();
  }
  /// False only when it never happens: the limit is far beyond any sensible time.
  bool wait_for_slices(std::size_t count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] { return slices_.size() >= count; });
  }
  bool wait_for(device::EventKind kind, std::size_t count = 1) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] { return count_locked(kind) >= count; });
  }
  std::size_t count(device::EventKind kind) {
    const std::lock_guard lock(mutex_);
    return count_locked(kind);
  }
  std::vector<std::shared_ptr<const device::DeliveredSlice>> slices() {
    const std::lock_guard lock(mutex_);
    return slices_;
  }
  std::vector<device::Event> events() {
    const std::lock_guard lock(mutex_);
    return events_;
  }

 private:
  std::size_t count_locked(device::EventKind kind) const {
    std::size_t n = 0;
    for (const auto& event : events_) n += event.kind == kind ? 1 : 0;
    return n;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::shared_ptr<const device::DeliveredSlice>> slices_;
  std::vector<device::Event> events_;
};

inline void check_closed(const device::Ledger& l) {
  CAPTURE(l.made);
  CAPTURE(l.delivered);
  CAPTURE(l.host_dropped);
  CAPTURE(l.crc_bad);
  CAPTURE(l.malformed);
  CAPTURE(l.transport_lost);
  CAPTURE(l.device_dropped);
  CHECK(l.closed);
  CHECK(l.made == l.delivered + l.host_dropped + l.crc_bad + l.malformed + l.transport_lost + l.device_dropped);
}

}  // namespace sonoloft::test
