#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

#include "host/device/clock/clock_map.h"
#include "host/device/clock/sync_schedule.h"

namespace sonoloft::device {

class Requester;

/// What is known of a device's clock.
struct ClockFigures {
  double drift_ppm = 0;                     ///< how much faster the host's clock runs
  std::chrono::nanoseconds round_trip{0};   ///< of a TIME_SYNC, see ClockMap::round_trip()
  std::chrono::nanoseconds uncertainty{0};  ///< of a time mapped last
};

/// Keeps a ClockMap in step with a device: sends it TIME_SYNC in bursts. A device that does not answer leaves times
/// unmapped; nothing else depends on it. Threads: burst() and next_burst() on one thread at a time, the rest on any.
class ClockKeeper {
 public:
  using Clock = std::chrono::steady_clock;
  /// Waits; false: no more exchanges.
  using Pause = std::function<bool(std::chrono::microseconds)>;

  /// @pre `requester` outlives the keeper
  ClockKeeper(Requester& requester, std::uint32_t seed) : requester_(requester), schedule_(seed) {}

  /// A burst of exchanges, now.
  void burst(const Pause& pause);
  /// When the next burst is due.
  [[nodiscard]] Clock::time_point next_burst() const { return next_burst_; }

  /// See ClockMap::at().
  [[nodiscard]] std::optional<HostTime> at(std::chrono::nanoseconds device_time);
  /// Nothing before a time was mapped.
  [[nodiscard]] std::optional<ClockFigures> figures() const;

 private:
  [[nodiscard]] std::optional<TimeExchange> exchange();

  Requester& requester_;
  SyncSchedule schedule_;
  Clock::time_point next_burst_{};

  mutable std::mutex mutex_;  ///< guards what follows; held for moments
  ClockMap map_;
  std::optional<HostTime> last_;
};

}  // namespace sonoloft::device
