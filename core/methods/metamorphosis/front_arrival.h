#pragma once
#include <vector>

#include "core/methods/metamorphosis/swept_parts.h"

namespace sonoloft {

/// When the front passes a node, as a share of its way, and how fast that share grows in the direction it runs.
struct NodeArrival {
  float way;     ///< 0 on the contour of the lower slice, 1 on that of the upper one
  float per_mm;  ///< > 0
};

/// The morph of one contour into the other over one part, in its stationary form. The front leaves the longer of the
/// two contours and runs along its normal as fast as it is far from the other one, g. This speed never changes its
/// sign, so the front passes every node once, at a time T with |grad T| = 1 / g; W = exp(-T) is what is left of a
/// straight way as a share, and W / g the gradient of it.
/// @pre   the part is not alone
/// @return [#nodes of the part]
/// @cost  O(n log n) in the nodes of the part
/// Source: level-set morph of Breen, Whitaker 2001 and Nilsson, Breen, Museth 2005, section 3; Sethian 1999 (fast
/// marching, second order).
class FrontArrival {
 public:
  FrontArrival(const PlaneGrid& grid, const SlicePair& slices);
  [[nodiscard]] std::vector<NodeArrival> over(const SweptParts& parts, std::uint32_t part);

 private:
  enum class State : std::uint8_t { far, trial, accepted };
  struct Trial {
    float left;
    std::uint32_t node;
    bool operator<(const Trial& o) const { return left != o.left ? left < o.left : node > o.node; }
  };
  struct Upwind {
    float value, weight;  ///< of weight * (value - W)^2 in the squared gradient
    float first_order;    ///< the value with weight 1
  };
  [[nodiscard]] Upwind upwind(std::size_t node, std::ptrdiff_t step) const;
  [[nodiscard]] float left_at(std::size_t node) const;
  /// Steps of the grid to the contour that the front leaves, and to its goal.
  [[nodiscard]] float gone(std::size_t node) const {
    return steps_to(node, upwards_ ? *slices_.lower : *slices_.upper);
  }
  [[nodiscard]] float to_goal(std::size_t node) const {
    return steps_to(node, upwards_ ? *slices_.upper : *slices_.lower);
  }
  [[nodiscard]] float steps_to(std::size_t node, const std::vector<float>& distance_mm) const;
  void march(const SweptParts& parts, std::uint32_t part);

  const PlaneGrid& grid_;
  SlicePair slices_;
  bool upwards_ = true;       ///< from the contour of the lower slice to that of the upper one
  std::vector<float> left_;   ///< [#nodes] W
  std::vector<State> state_;  ///< [#nodes]
  std::vector<Trial> heap_;
};

}  // namespace sonoloft
