#pragma once
#include <doctest/doctest.h>

#include <vector>

#include "core/slopes/contour_slopes.h"

namespace sonoloft::test {

/// Slices with the slopes of their contours.
struct SlopedSlices {
  CellComplex cells{{Eigen::Vector3d::Constant(-200), Eigen::Vector3d::Constant(200)}, 0.05};
  ContourSlopes slopes;

  explicit SlopedSlices(double feature_mm) : slopes(feature_mm) {}

  SliceId add(Section section) {
    const auto delta = cells.insert(std::move(section));
    REQUIRE(delta);
    slopes.note(*delta);
    return delta->slice;
  }
};

}  // namespace sonoloft::test
