#pragma once
#include <cstdint>
#include <vector>

#include "host/apps/picture/scene.h"

namespace sonoloft {

inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFF;

/// What a sample sees first: the nearest triangle, of equally near ones the one with the lowest index.
struct Layer {
  std::vector<std::uint32_t> triangle;  ///< [width * height] kNoTriangle: nothing
  std::vector<float> inverse_depth;     ///< [width * height] 0: nothing
};

/// A triangle seen from the eye.
struct Seen {
  Label near;    ///< the label before it
  Label far;     ///< the label behind it
  Label colour;  ///< the label that it shows
  bool glass;
};

struct Layers {
  Layer solid;
  Layer glass;
};

/// How a triangle looks when its face is turned to the eye (`to_eye`) or away from it.
[[nodiscard]] Seen seen(const Scene& scene, std::size_t triangle, bool to_eye);

/// Whether the ray meets the front of the triangle.
[[nodiscard]] inline bool to_eye(const Scene& scene, std::size_t triangle, const Eigen::Vector3f& ray) {
  return scene.face_normal[triangle].dot(ray) < 0;
}

/// Corner weights of a sample of a triangle, corrected for perspective. They add up to 1.
[[nodiscard]] Eigen::Vector3f weights(const Scene& scene, std::size_t triangle, int column, int row);

/// Finds what every sample sees. @cost O(#T + samples covered)
[[nodiscard]] Layers rasterise(const Scene& scene, int threads);

}  // namespace sonoloft
