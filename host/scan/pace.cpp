#include "host/scan/pace.h"

#include <algorithm>

namespace sonoloft {
namespace {

/// Half the spacing is four times the surface samples and triangles.
constexpr int kOverNextCoarser = 4;

constexpr std::array kFromFinest = {Detail::full, Detail::coarse, Detail::draft};

}  // namespace

void Pace::slice_arrived(Clock::time_point when) {
  if (last_arrival_) gaps_[gap_count_++ % gaps_.size()] = when - *last_arrival_;
  last_arrival_ = when;
}

void Pace::took(Detail detail, Clock::duration time) {
  for (int coarser = 0; coarser < static_cast<int>(detail); ++coarser) time *= kOverNextCoarser;
  full_time_ = (full_time_ + time) / 2;
}

Pace::Clock::duration Pace::between_slices() const {
  auto gaps = gaps_;
  const auto end = gaps.begin() + static_cast<std::ptrdiff_t>(std::min(gap_count_, gaps.size()));
  const auto middle = gaps.begin() + (end - gaps.begin()) / 2;
  std::nth_element(gaps.begin(), middle, end);
  return *middle;
}

Detail Pace::next() const {
  if (gap_count_ == 0) return Detail::full;
  Clock::duration time = full_time_;
  for (const Detail detail : kFromFinest) {
    if (time <= between_slices()) return detail;
    time /= kOverNextCoarser;
  }
  return kFromFinest.back();
}

Pace::Clock::duration Pace::patience() const {
  return 2 * between_slices();
}

}  // namespace sonoloft
