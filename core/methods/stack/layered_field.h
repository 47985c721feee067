#pragma once
#include <span>
#include <vector>

#include "core/methods/stack/plane_grid.h"
#include "core/slice/label.h"

namespace sonoloft {

/// What a method for parallel slices makes of them: at every height, how far each node of a grid lies inside of each
/// label. The label with the largest value has the node. Frame: the stack's. Threads: const members may run together.
class LayeredField {
 public:
  virtual ~LayeredField() = default;
  [[nodiscard]] virtual const PlaneGrid& grid() const = 0;
  /// [#labels] ascending; outside is the first
  [[nodiscard]] virtual const std::vector<Label>& labels() const = 0;
  /// Heights between which there is anything but outside, mm.
  [[nodiscard]] virtual double lowest_mm() const = 0;
  [[nodiscard]] virtual double highest_mm() const = 0;
  /// @param values_mm  out: [#labels][#nodes] about the distance to the label's surface where that is near, negative
  ///                   outside of it; any number of the same sign where it is far
  virtual void layer(double height_mm, std::span<float> values_mm) const = 0;
};

}  // namespace sonoloft
