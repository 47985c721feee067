#include "host/apps/picture/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr int kSamples = 20;
constexpr int kPattern = 4;
constexpr float kStrength = 2.0f;
constexpr float kLargestShare = 0.15f;  // of the picture's height: the reach in pixels of what is very near

using Offsets = std::array<Eigen::Vector2f, kSamples>;

/// The spiral of samples in the unit disc, turned by one of the pattern's 16 angles.
std::array<Offsets, kPattern * kPattern> make_spirals() {
  constexpr std::array<int, kPattern * kPattern> kOrder{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
  std::array<Offsets, kPattern * kPattern> spirals;
  for (std::size_t p = 0; p < spirals.size(); ++p) {
    for (int i = 0; i < kSamples; ++i) {
      const float angle = 2.39996323f * static_cast<float>(i) + 6.2831853f / 16 * static_cast<float>(kOrder[p]);
      const float radius = (static_cast<float>(i) + 0.5f) / kSamples;
      spirals[p][static_cast<std::size_t>(i)] = radius * Eigen::Vector2f(std::cos(angle), std::sin(angle));
    }
  }
  return spirals;
}

class Occlusion {
 public:
  Occlusion(const DepthImage& image, float radius_mm)
      : image_(image), radius_mm_(radius_mm), spirals_(make_spirals()) {}

  [[nodiscard]] float raw(int x, int y) const {
    const float depth = image_.depth_mm[at(x, y)];
    if (depth <= 0) return 1;
    const Eigen::Vector3f p = position(x, y, depth);
    const Eigen::Vector3f& n = image_.normal[at(x, y)];
    const float reach_px =
        std::clamp(radius_mm_ * image_.focal_px / depth, 4.0f, kLargestShare * static_cast<float>(image_.height_px));
    float sum = 0;
    for (const Eigen::Vector2f& offset : spirals_[static_cast<std::size_t>(x % kPattern + kPattern * (y % kPattern))]) {
      const int sx = x + static_cast<int>(std::lround(offset.x() * reach_px));
      const int sy = y + static_cast<int>(std::lround(offset.y() * reach_px));
      if (sx < 0 || sy < 0 || sx >= image_.width_px || sy >= image_.height_px) continue;
      const float other = image_.depth_mm[at(sx, sy)];
      if (other <= 0) continue;
      const Eigen::Vector3f v = (position(sx, sy, other) - p) / radius_mm_;
      const float d2 = v.squaredNorm();
      if (d2 < 1) sum += (1 - d2) * std::max(0.0f, v.dot(n) - 0.02f) / (d2 + 0.01f);
    }
    return std::max(0.0f, 1 - kStrength * sum / kSamples);
  }

  /// The mean of `raw` over one period of the pattern, over neighbours of about the same depth.
  [[nodiscard]] float smooth(const std::vector<float>& raw, int x, int y) const {
    const float depth = image_.depth_mm[at(x, y)];
    if (depth <= 0) return 1;
    float sum = 0, count = 0;
    for (int sy = std::max(0, y - 2); sy < std::min(image_.height_px, y + 2); ++sy) {
      for (int sx = std::max(0, x - 2); sx < std::min(image_.width_px, x + 2); ++sx) {
        if (std::abs(image_.depth_mm[at(sx, sy)] - depth) > 0.25f * radius_mm_) continue;
        sum += raw[at(sx, sy)];
        count += 1;
      }
    }
    return sum / count;
  }

  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(x) + static_cast<std::size_t>(image_.width_px) * static_cast<std::size_t>(y);
  }

 private:
  [[nodiscard]] Eigen::Vector3f position(int x, int y, float depth) const {
    const float scale = depth / image_.focal_px;
    return {(static_cast<float>(x) + 0.5f - 0.5f * static_cast<float>(image_.width_px)) * scale,
            (static_cast<float>(y) + 0.5f - 0.5f * static_cast<float>(image_.height_px)) * scale, depth};
  }

  const DepthImage& image_;
  float radius_mm_;
  std::array<Offsets, kPattern * kPattern> spirals_;
};

}  // namespace

std::vector<float> ambient_occlusion(const DepthImage& image, float radius_mm, int threads) {
  const Occlusion occlusion(image, radius_mm);
  const auto each_pixel = [&](auto&& value) {
    std::vector<float> result(image.depth_mm.size());
    parallel_for(static_cast<std::size_t>(image.height_px), 16, threads, [&](std::size_t first, std::size_t last) {
      for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
        for (int x = 0; x < image.width_px; ++x) result[occlusion.at(x, y)] = value(x, y);
      }
    });
    return result;
  };
  const std::vector<float> raw = each_pixel([&](int x, int y) { return occlusion.raw(x, y); });
  return each_pixel([&](int x, int y) { return occlusion.smooth(raw, x, y); });
}

}  // namespace sonoloft
