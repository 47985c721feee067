#include "host/device/clock/clock_keeper.h"

#include <vector>

#include "host/device/requester.h"

namespace sonoloft::device {
namespace {

constexpr std::chrono::milliseconds kPatience{100};

std::int64_t now_ns() {
  return std::chrono::nanoseconds(ClockKeeper::Clock::now().time_since_epoch()).count();
}

}  // namespace

void ClockKeeper::burst(const Pause& pause) {
  std::vector<TimeExchange> exchanges;
  do {
    const auto done = exchange();
    if (!done) break;
    exchanges.push_back(*done);
  } while (exchanges.size() < SyncSchedule::kBurst && pause(schedule_.pause_in_burst()));
  const std::lock_guard lock(mutex_);
  if (map_.add(exchanges)) schedule_.begin_anew();
  next_burst_ = Clock::now() + schedule_.pause();
}

std::optional<TimeExchange> ClockKeeper::exchange() {
  const std::int64_t sent = now_ns();
  const protocol::TimeSyncRequest request{static_cast<std::uint64_t>(sent)};
  const auto reply =
      requester_.ask<protocol::TimeSyncReply>(protocol::Command::time_sync, protocol::bytes_of(request), kPatience);
  if (!reply || reply->host_ns != request.host_ns) return std::nullopt;
  return TimeExchange{sent, reply->device_ns, now_ns()};
}

std::optional<HostTime> ClockKeeper::at(std::chrono::nanoseconds device_time) {
  const std::lock_guard lock(mutex_);
  auto mapped = map_.at(static_cast<std::uint64_t>(device_time.count()));
  if (mapped) last_ = mapped;
  return mapped;
}

std::optional<ClockFigures> ClockKeeper::figures() const {
  const std::lock_guard lock(mutex_);
  if (!last_) return std::nullopt;
  return ClockFigures{map_.drift_ppm(), map_.round_trip(), last_->uncertainty};
}

}  // namespace sonoloft::device
