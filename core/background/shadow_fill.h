#pragma once
// add, remove:  Section -> [RASTER, SHADOWS FILLED] -> splat -> NodeData
#include <cstdint>
#include <vector>

#include "core/slice/section_raster.h"

namespace sonoloft {

/// A raster and how much each pixel counts.
struct FilledRaster {
  SectionRaster raster;
  std::vector<std::uint8_t> weight;  ///< [height][width] in units of 1 / kPixelUnit; 0 where unknown
};
inline constexpr int kPixelUnit = 16;

/// Gives every small unknown region that known pixels enclose the labels around it, a quarter of a pixel's weight each.
/// @cost O(pixels, and in shadows pixels times those around)
[[nodiscard]] FilledRaster fill_shadows(SectionRaster raster);

}  // namespace sonoloft
