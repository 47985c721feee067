#pragma once
#include <memory>
#include <string>
#include <vector>

#include "device_sim/probe/phantom.h"

/// Bodies given by formulas, to measure a reconstruction against; about 100 mm long and free of anybody's licence.
namespace sonoloft::test {

struct NamedBody {
  std::string name;
  std::shared_ptr<const device_sim::Phantom> body;
};

/// One label each: sphere, ellipsoid, torus, cone, oblique cylinder, branching tube, thin slab; none along an axis.
[[nodiscard]] std::vector<NamedBody> bodies_of_one_label();

/// Labels 1 and 2 are the two sides of an ellipsoid, parted by a tilted, wavy wall; 3 is a ball across that wall. Most
/// planes through it show points where three labels meet.
[[nodiscard]] NamedBody body_of_three_labels();

}  // namespace sonoloft::test
