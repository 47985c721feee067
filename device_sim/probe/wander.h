#pragma once
#include <Eigen/Core>
#include <cmath>

#include "device_sim/probe/random.h"

namespace sonoloft::device_sim {

/// Three independent numbers of mean 0 and standard deviation 1 that change gradually: autoregressive processes of
/// order one.
class Wander {
 public:
  explicit Wander(Random& random) : value_(random.normal3()) {}
  /// @param correlation of the next value with this one, 0 <= value < 1
  void step(double correlation, Random& random) {
    value_ = correlation * value_ + std::sqrt(1 - correlation * correlation) * random.normal3();
  }
  [[nodiscard]] const Eigen::Vector3d& value() const { return value_; }

 private:
  Eigen::Vector3d value_;
};

}  // namespace sonoloft::device_sim
