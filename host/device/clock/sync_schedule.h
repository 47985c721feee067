#pragma once
#include <chrono>
#include <cstdint>
#include <random>

namespace sonoloft::device {

/// When to ask for the device's clock: bursts of eight exchanges, often in the first seconds and every 1 to 5 s later.
/// All pauses are random, so that they fall into step with nothing else on the bus. Threads: one at a time.
class SyncSchedule {
 public:
  static constexpr int kBurst = 8;

  explicit SyncSchedule(std::uint32_t seed) : random_(seed) {}

  /// As in the first seconds again.
  void begin_anew() { bursts_ = 0; }

  /// Between two exchanges of a burst.
  [[nodiscard]] std::chrono::microseconds pause_in_burst() { return std::chrono::microseconds(100 + random_() % 1900); }

  /// Between two bursts.
  [[nodiscard]] std::chrono::milliseconds pause() {
    if (bursts_ < kQuickBursts) {
      ++bursts_;
      return std::chrono::milliseconds(100 + random_() % 150);
    }
    return std::chrono::milliseconds(1000 + random_() % 4000);
  }

 private:
  static constexpr int kQuickBursts = 24;  // about 4 s

  std::minstd_rand random_;
  int bursts_ = 0;
};

}  // namespace sonoloft::device
