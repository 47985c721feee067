#include "device_sim/port/loopback_device.h"

#include <cassert>
#include <chrono>

#include "protocol/record.h"

namespace sonoloft::device_sim {

LoopbackDevice::LoopbackDevice(const LoopbackOptions& options, SliceSource source)
    : memory_(options.ring_records * (record_slot_len(options.firmware.limits) / sizeof(Block))),
      firmware_(options.firmware, std::as_writable_bytes(std::span(memory_))),
      cable_(firmware_),
      acquisition_([this, source = std::move(source), rate_hz = options.rate_hz] { acquire_all(source, rate_hz); }) {
  assert(!options.rate_hz || *options.rate_hz > 0);
}

LoopbackDevice::~LoopbackDevice() {
  cable_.shut_down();
}

void LoopbackDevice::acquire_all(const SliceSource& source, std::optional<double> rate_hz) {
  using Clock = Cable::Clock;
  constexpr std::chrono::milliseconds kEndPeriod{20};
  const auto period = rate_hz ? std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / *rate_hz))
                              : Clock::duration::zero();
  std::optional<Clock::time_point> due;
  if (rate_hz) due = Clock::now();
  while (cable_.wait_to_acquire(due)) {
    const AcquiredSlice* slice = source();
    if (slice == nullptr) break;
    cable_.acquire(*slice);
    // After a pause the rate goes on from now, it does not catch up.
    if (due) due = std::max(*due + period, Clock::now());
  }
  // Every later session finds the source at its end, too.
  while (cable_.wait_to_acquire(Clock::now() + kEndPeriod)) cable_.end_of_source();
}

}  // namespace sonoloft::device_sim
