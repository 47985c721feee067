#include "core/methods/metamorphosis/label_morph.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

using Course = FrontNode::Course;

/// The way of a front that meets itself at t = 1 and runs on beyond. @param start  its slope at t = 0, 0..2
float ending_way(float start, float t) {
  return t < 1 ? t * (start + (1 - start) * t) : 1 + (2 - start) * (t - 1);
}
float ending_slope(float start, float t) {
  return t < 1 ? start + 2 * (1 - start) * t : 2 - start;
}

/// How far the front is from a node, measured at a right angle to the surface.
float distance(const FrontNode& n, float t, float height_mm) {
  float way = 0, slope = 0;
  if (n.course == Course::between) {
    way = n.passage.way(t);
    slope = n.passage.slope(t);
  } else {
    t = (n.course == Course::from_lower ? t : 1 - t) / kEnd;
    way = ending_way(n.passage.at_start, t);
    slope = ending_slope(n.passage.at_start, t) / kEnd;
  }
  const float climb = n.change_mm * slope / height_mm;
  return (n.start_mm + n.change_mm * way) / std::sqrt(1 + climb * climb);
}

}  // namespace

LabelMorph::LabelMorph(const PlaneGrid& grid, DistanceStack stack, int threads)
    : stack_(std::move(stack)),
      far_mm_(8 * static_cast<float>(grid.spacing_mm)),
      sweeps_(stack_.heights_mm.size() - 1) {
  parallel_for(sweeps_.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      sweeps_[i] = sweep_between(grid, {&stack_.distances_mm[i], &stack_.distances_mm[i + 1]},
                                 stack_.heights_mm[i + 1] - stack_.heights_mm[i]);
  });
  parallel_for(sweeps_.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) time(i);
  });
  for (FrontSweep& sweep : sweeps_) sweep.speed = {};
}

/// The front's speed in a slice, the same seen from below and from above.
float LabelMorph::speed_at(std::size_t slice, std::size_t node) const {
  if (slice == 0) return sweeps_[0].speed[node];
  if (slice == sweeps_.size()) return sweeps_.back().speed[node];
  return speed_through(sweeps_[slice - 1].speed[node], sweeps_[slice].speed[node], height_mm(slice - 1),
                       height_mm(slice));
}

void LabelMorph::time(std::size_t interval) {
  const float height = height_mm(interval);
  for (FrontNode& n : sweeps_[interval].nodes) {
    const auto at = [&](std::size_t slice, float share, float most) {
      return passage_slope(speed_at(slice, n.node), share * height, n.change_mm, most);
    };
    n.passage = n.course == Course::between      ? Passage{at(interval, 1, 3), at(interval + 1, 1, 3)}
                : n.course == Course::from_lower ? Passage{at(interval, kEnd, 2), 0}
                                                 : Passage{at(interval + 1, -kEnd, 2), 0};
  }
}

void LabelMorph::layer(double height_mm_above, std::span<float> out_mm) const {
  assert(height_mm_above >= stack_.heights_mm.front() && height_mm_above <= stack_.heights_mm.back());
  const auto above = std::upper_bound(stack_.heights_mm.begin() + 1, stack_.heights_mm.end() - 1, height_mm_above);
  const auto interval = static_cast<std::size_t>(above - stack_.heights_mm.begin()) - 1;
  const std::vector<float>&lower = stack_.distances_mm[interval], &upper = stack_.distances_mm[interval + 1];
  for (std::size_t n = 0; n < lower.size(); ++n) out_mm[n] = lower[n] > 0 && upper[n] > 0 ? far_mm_ : -far_mm_;
  const float height = height_mm(interval);
  const auto t = static_cast<float>((height_mm_above - stack_.heights_mm[interval]) / static_cast<double>(height));
  for (const FrontNode& n : sweeps_[interval].nodes) out_mm[n.node] = distance(n, t, height);
}

}  // namespace sonoloft
