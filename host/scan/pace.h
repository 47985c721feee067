#pragma once
// how fast slices come, how long meshes take -> [PACE] -> how finely to draw the next one
#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

#include "core/reconstructor/reconstructor.h"

namespace sonoloft {

/// Keeps the meshes of a live scan up with its slices: the finest detail of which the next update takes less time than
/// lies between two slices, and those after it will too if they have as much to do as the last ones had. An update's
/// time is foreseen from the samples that it has to take. Threads: one at a time.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;
  /// [Detail] Reconstructor::samples_due() once the slices are added.
  using SamplesDue = std::array<std::size_t, kDetails>;

  void slice_arrived(Clock::time_point when);
  /// An update for which so many samples were due took so long for these (UpdateReport::sampling_ms()), and for all
  /// else from the queue to the finished mesh.
  void took(std::size_t samples_due, double sampling_ms, double besides_ms);

  /// Of the update at hand. Full before two slices have come. @param shown  the detail of the last one
  [[nodiscard]] Detail next(Detail shown, const SamplesDue& due);
  /// When no slice came for so long, there is time for a full mesh: twice the usual time between two slices.
  [[nodiscard]] Clock::duration patience() const;

 private:
  static constexpr std::size_t kRemembered = 9;

  /// The median of the last ones: a pause of the hand that sweeps is none of them.
  [[nodiscard]] Clock::duration between_slices() const;
  [[nodiscard]] Clock::duration expected(double samples_due) const;

  std::array<Clock::duration, kRemembered> gaps_{};  ///< the last ones, in a ring
  std::size_t gap_count_ = 0;                        ///< so far
  std::optional<Clock::time_point> last_arrival_;
  std::array<double, kRemembered> samples_{};  ///< that the last updates had to take, in full detail, in a ring
  std::size_t update_count_ = 0;               ///< so far
  // Sums over the updates, of which each before the last counts half as much:
  double weight_ = 0, besides_ms_ = 0, sampling_ms_ = 0, samples_due_ = 0;
};

}  // namespace sonoloft
