#pragma once
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "core/slice/section.h"

namespace sonoloft::test {

/// The label of a point of space that lies in the slice.
inline Label label_in_space(const TrackedSlice& slice, const Eigen::Vector3d& p) {
  const auto section = make_section(slice);
  REQUIRE(section.has_value());
  const Eigen::Vector3d image = slice.image_to_reference.inverse() * p;
  CHECK(std::abs(image.z()) < 1e-9);
  return label_at(*section, image.head<2>());
}

}  // namespace sonoloft::test
