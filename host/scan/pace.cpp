#include "host/scan/pace.h"

#include <algorithm>

namespace sonoloft {
namespace {

/// Sampling takes time for as many samples before the first one: cells are packed. Measured: 2,000 to 40,000.
constexpr double kBeforeSamples = 10'000;
/// Of the time between two slices. Measured: half of all updates take .85 to 1.11 of what is foreseen, a tenth
/// over 1.2.
constexpr double kShare = 0.9;

}  // namespace

void Pace::slice_arrived(Clock::time_point when) {
  if (last_arrival_) gaps_[gap_count_++ % gaps_.size()] = when - *last_arrival_;
  last_arrival_ = when;
}

void Pace::took(std::size_t samples_due, double sampling_ms, double besides_ms) {
  const auto add = [](double& sum, double last) { sum = sum / 2 + last; };
  add(weight_, 1);
  add(besides_ms_, besides_ms);
  add(sampling_ms_, sampling_ms);
  add(samples_due_, static_cast<double>(samples_due) + kBeforeSamples);
}

Pace::Clock::duration Pace::between_slices() const {
  auto gaps = gaps_;
  const auto end = gaps.begin() + static_cast<std::ptrdiff_t>(std::min(gap_count_, gaps.size()));
  const auto middle = gaps.begin() + (end - gaps.begin()) / 2;
  std::nth_element(gaps.begin(), middle, end);
  return *middle;
}

Pace::Clock::duration Pace::expected(double samples_due) const {
  if (weight_ == 0) return {};
  const std::chrono::duration<double, std::milli> time(besides_ms_ / weight_ +
                                                       sampling_ms_ / samples_due_ * (samples_due + kBeforeSamples));
  return std::chrono::duration_cast<Clock::duration>(time);
}

Detail Pace::next(Detail shown, const SamplesDue& due) {
  // The detail shown is up to date but for what is new.
  double in_full = 1;
  for (int finer = 0; finer < static_cast<int>(shown); ++finer) in_full *= kOverNextCoarser;
  samples_[update_count_++ % samples_.size()] = in_full * static_cast<double>(due[static_cast<std::size_t>(shown)]);
  if (gap_count_ == 0) return Detail::full;

  const auto limit = std::chrono::duration_cast<Clock::duration>(kShare * between_slices());
  double usual = *std::max_element(samples_.begin(), samples_.end());
  Detail quickest = shown;
  Clock::duration least = Clock::duration::max();
  for (const Detail detail : {Detail::full, Detail::coarse, Detail::draft}) {
    const Clock::duration now = expected(static_cast<double>(due[static_cast<std::size_t>(detail)]));
    // A finer one has to catch up, once.
    if (detail < shown ? now <= patience() && expected(usual) <= limit : now <= limit) return detail;
    if (now < least) least = now, quickest = detail;
    usual /= kOverNextCoarser;
  }
  return quickest;
}

Pace::Clock::duration Pace::patience() const {
  return 2 * between_slices();
}

}  // namespace sonoloft
