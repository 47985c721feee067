#pragma once
#include "host/apps/picture/raster.h"

namespace sonoloft {

/// Lights what the samples see and averages them to pixels. @cost O(samples)
[[nodiscard]] Picture shade(const Scene& scene, const Layers& layers, const PictureOptions& options, int threads);

}  // namespace sonoloft
