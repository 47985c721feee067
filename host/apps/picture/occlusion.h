#pragma once
#include <Eigen/Core>
#include <vector>

namespace sonoloft {

/// What is visible at each pixel, as far as occlusion needs it.
struct DepthImage {
  int width_px, height_px;
  float focal_px;                       ///< pixels per unit of x / z
  std::vector<float> depth_mm;          ///< [pixels] 0: nothing
  std::vector<Eigen::Vector3f> normal;  ///< [pixels] view frame, towards the eye
};

/// How much of the surroundings each pixel sees, 0 (nothing) to 1: shading that makes hollows and contacts readable.
/// Source: McGuire, Osman, Bukowski, Hennessy 2011 (Alchemy screen-space ambient obscurance), equation 10, with a
/// spiral of samples turned by a 4 x 4 pattern and a 4 x 4 mean that stays on one surface. Threads: any number, same
/// result.
[[nodiscard]] std::vector<float> ambient_occlusion(const DepthImage& image, float radius_mm, int threads);

}  // namespace sonoloft
