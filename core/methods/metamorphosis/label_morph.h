#pragma once
#include <span>
#include <vector>

#include "core/methods/metamorphosis/front_sweep.h"

namespace sonoloft {

/// A stack's slices as one label sees them.
struct DistanceStack {
  std::vector<double> heights_mm;                ///< [#S] ascending
  std::vector<std::vector<float>> distances_mm;  ///< [#S][#nodes] positive inside; see signed_distance()
};

/// One label's front on its way through a stack of slices: where it is at every height. Frame: the stack's.
/// Threads: const members may run together.
class LabelMorph {
 public:
  /// @cost O(#slices * #nodes) for comparing slices, and O(n log n) in the nodes that fronts sweep or come near
  LabelMorph(const PlaneGrid& grid, DistanceStack stack, int threads);

  /// @param out_mm  [#nodes] about the distance to the surface where that is within two nodes, positive inside
  /// @pre   the height is that of the first slice, of the last one, or between
  /// @cost  O(#nodes) to fill, and about 10 ns a node near the front's way
  void layer(double height_mm, std::span<float> out_mm) const;

  /// [#S - 1] what ended between two slices for want of a counterpart.
  [[nodiscard]] const std::vector<FrontSweep>& sweeps() const { return sweeps_; }

 private:
  void time(std::size_t interval);
  [[nodiscard]] float speed_at(std::size_t slice, std::size_t node) const;
  [[nodiscard]] float height_mm(std::size_t interval) const {
    return static_cast<float>(stack_.heights_mm[interval + 1] - stack_.heights_mm[interval]);
  }

  DistanceStack stack_;
  float far_mm_;  ///< what nodes have that only have a sign
  std::vector<FrontSweep> sweeps_;
};

}  // namespace sonoloft
