#pragma once
// how fast slices come, how long meshes take -> [PACE] -> how finely to draw the next one
#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

#include "core/reconstructor/reconstructor.h"

namespace sonoloft {

/// Keeps the meshes of a live scan up with its slices: the finest detail that takes less time than lies between two
/// slices, or the coarsest. Threads: one at a time.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  void slice_arrived(Clock::time_point when);
  /// An update of this detail, from the queue to the finished mesh, took so long.
  void took(Detail detail, Clock::duration time);

  /// Of the next update. Full before two slices have come.
  [[nodiscard]] Detail next() const;
  /// When no slice came for so long, there is time for a full mesh: twice the usual time between two slices.
  [[nodiscard]] Clock::duration patience() const;

 private:
  /// The median of the last ones: a pause of the hand that sweeps is none of them.
  [[nodiscard]] Clock::duration between_slices() const;

  std::array<Clock::duration, 9> gaps_{};  ///< the last ones, in a ring
  std::size_t gap_count_ = 0;              ///< so far
  std::optional<Clock::time_point> last_arrival_;
  Clock::duration full_time_{};  ///< that a full update is expected to take
};

}  // namespace sonoloft
