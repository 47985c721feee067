#include "host/apps/picture/shade.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/slice/parallel.h"
#include "host/apps/picture/occlusion.h"

namespace sonoloft {
namespace {

using Color = Eigen::Array3f;  // linear light

// Directions to the lights, view frame (x right, y down, z forward): the key above the observer's left shoulder.
const Eigen::Vector3f kKey = Eigen::Vector3f(-0.62f, -0.66f, -0.42f).normalized();
const Eigen::Vector3f kFill = Eigen::Vector3f(0.80f, 0.15f, -0.45f).normalized();
const Color kKeyColor(1.18f, 1.12f, 1.04f), kFillColor(0.16f, 0.19f, 0.25f);
const Color kSky(0.27f, 0.29f, 0.33f), kGround(0.10f, 0.09f, 0.09f);
constexpr float kOcclusionReach = 0.09f;  // of the scene's size
constexpr std::uint32_t kOnCut = 1u << 16;
constexpr float kEdgeGap = 0.02f;  // of the scene's size: a step in depth that gets an outline

/// A place on a surface, or nothing (label outside).
struct Hit {
  Label label = kOutside;
  float depth = 0;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< view frame, towards the eye
  bool flat = false;                                 ///< on the cut
};

struct Hits {
  Hit solid, glass;  ///< glass only where it lies before the solid
};

class Shader {
 public:
  Shader(const Scene& scene, const Layers& layers, const PictureOptions& options)
      : scene_(scene), layers_(layers), options_(options) {
    for (std::size_t i = 0; i < linear_.size(); ++i) {
      linear_[i] = std::pow(static_cast<float>(i) / 255.0f, 2.2f);
    }
    const auto samples = layers.solid.triangle.size();
    surface_.assign(samples, kOutside);
    depth_.assign(samples, 0.0f);
  }

  Picture run(int threads) {
    const int width = scene_.camera.width / 2, height = scene_.camera.height / 2;
    DepthImage image{width, height, static_cast<float>(scene_.camera.focal / 2), {}, {}};
    image.depth_mm.resize(surface_.size() / 4);
    image.normal.resize(surface_.size() / 4);
    const auto each_row = [&](auto&& visit) {
      parallel_for(static_cast<std::size_t>(height), 16, threads, [&](std::size_t first, std::size_t last) {
        for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) visit(y);
      });
    };
    each_row([&](int y) { find_surfaces(y, image); });
    occlusion_ = ambient_occlusion(image, kOcclusionReach * scene_.size_mm, threads);
    Picture picture{width, height, std::vector<std::uint8_t>(3 * occlusion_.size())};
    each_row([&](int y) { shade_row(y, picture); });
    return picture;
  }

 private:
  [[nodiscard]] std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(column) +
           static_cast<std::size_t>(scene_.camera.width) * static_cast<std::size_t>(row);
  }

  [[nodiscard]] Hit hit_of(const Layer& layer, int column, int row, const Eigen::Vector3f& ray) const {
    const std::uint32_t triangle = layer.triangle[at(column, row)];
    if (triangle == kNoTriangle) return {};
    const bool facing = to_eye(scene_, triangle, ray);
    const auto& corners = scene_.corner_normal[triangle];
    const Eigen::Vector3f w = weights(scene_, triangle, column, row);
    const Eigen::Vector3f normal = (w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2]).stableNormalized();
    return {seen(scene_, triangle, facing).colour, 1 / layer.inverse_depth[at(column, row)],
            facing ? normal : Eigen::Vector3f(-normal), false};
  }

  /// The label in which the ray passes the cut: the one before the first thing that it meets behind it.
  [[nodiscard]] Label label_at_cut(int column, int row, const Eigen::Vector3f& ray) const {
    const std::size_t i = at(column, row);
    const Layer& first =
        layers_.glass.inverse_depth[i] > layers_.solid.inverse_depth[i] ? layers_.glass : layers_.solid;
    if (first.triangle[i] == kNoTriangle) return kOutside;
    return seen(scene_, first.triangle[i], to_eye(scene_, first.triangle[i], ray)).near;
  }

  [[nodiscard]] Hits hits(int column, int row) const {
    const Eigen::Vector3f ray = scene_.camera.ray(column, row);
    const std::size_t i = at(column, row);
    Hits found{hit_of(layers_.solid, column, row, ray), {}};
    if (layers_.glass.inverse_depth[i] > layers_.solid.inverse_depth[i]) {
      found.glass = hit_of(layers_.glass, column, row, ray);
    }
    const float entry = scene_.cut ? scene_.cut->entry_depth(ray) : 0.0f;
    const Label cut_label = entry > 0 ? label_at_cut(column, row, ray) : kOutside;
    if (cut_label != kOutside) {
      const Hit cap{cut_label, entry, scene_.cut->normal, true};
      if (scene_.glass[cut_label]) {
        found.glass = cap;
      } else {
        found = {cap, {}};
      }
    }
    return found;
  }

  void find_surfaces(int y, DepthImage& image) {
    for (int row = 2 * y; row < 2 * y + 2; ++row) {
      for (int column = 0; column < scene_.camera.width; ++column) {
        const Hit hit = hits(column, row).solid;
        surface_[at(column, row)] = hit.label + (hit.flat ? kOnCut : 0u);
        depth_[at(column, row)] = hit.depth;
        const auto pixel = static_cast<std::size_t>(column / 2) +
                           static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(y);
        if (hit.label != kOutside && image.depth_mm[pixel] <= 0) {
          image.depth_mm[pixel] = hit.depth;
          image.normal[pixel] = hit.normal;
        }
      }
    }
  }

  [[nodiscard]] Color color_of(Label label) const {
    const auto rgb = options_.labels.colour(label);
    return {linear_[rgb[0]], linear_[rgb[1]], linear_[rgb[2]]};
  }

  [[nodiscard]] Color lit(const Hit& hit, const Eigen::Vector3f& ray, float open) const {
    const Eigen::Vector3f eye = -ray.normalized();
    const Color base = color_of(hit.label);
    if (hit.flat) return 0.9f * base + 0.05f;
    const float key = std::max(0.0f, hit.normal.dot(kKey)), fill = std::max(0.0f, hit.normal.dot(kFill));
    const float sky = 0.5f - 0.5f * hit.normal.y();
    const float grazing = 1 - std::clamp(hit.normal.dot(eye), 0.0f, 1.0f);
    const float shine = std::pow(std::max(0.0f, hit.normal.dot((kKey + eye).normalized())), 48.0f);
    const Color ambient = (kGround + sky * (kSky - kGround)) * open;
    const Color diffuse = (key * kKeyColor + fill * kFillColor) * (0.45f + 0.55f * open);
    return base * (ambient + diffuse) + 0.14f * shine * open + 0.08f * grazing * grazing * grazing * open;
  }

  /// Outlines: where a neighbour a pixel away shows another label, the cut begins, or it lies far nearer or farther.
  [[nodiscard]] float edge(int column, int row) const {
    const std::uint32_t surface = surface_[at(column, row)];
    const float depth = depth_[at(column, row)];
    for (const auto& [dx, dy] : {std::pair(-2, 0), std::pair(2, 0), std::pair(0, -2), std::pair(0, 2)}) {
      const int x = std::clamp(column + dx, 0, scene_.camera.width - 1);
      const int y = std::clamp(row + dy, 0, scene_.camera.height - 1);
      const std::uint32_t other = surface_[at(x, y)];
      if (other == kOutside) continue;
      if (other != surface || std::abs(depth_[at(x, y)] - depth) > kEdgeGap * scene_.size_mm) return 0.55f;
    }
    return 1.0f;
  }

  [[nodiscard]] Color background(int row) const {
    const float share = static_cast<float>(row) / static_cast<float>(scene_.camera.height);
    const Color top = options_.dark ? Color(0.030f, 0.036f, 0.048f) : Color(0.95f, 0.96f, 0.97f);
    const Color bottom = options_.dark ? Color(0.006f, 0.007f, 0.010f) : Color(0.70f, 0.73f, 0.78f);
    return top + share * (bottom - top);
  }

  [[nodiscard]] Color color_at(int column, int row, float open) const {
    const Eigen::Vector3f ray = scene_.camera.ray(column, row);
    const Hits found = hits(column, row);
    Color color = background(row);
    if (found.solid.label != kOutside) color = lit(found.solid, ray, open) * edge(column, row);
    if (found.glass.label != kOutside) {
      const float grazing = 1 - std::clamp(found.glass.normal.dot(-ray.normalized()), 0.0f, 1.0f);
      const float opacity = found.glass.flat ? 0.35f : 0.26f + 0.60f * grazing * grazing;
      color += opacity * (lit(found.glass, ray, 1.0f) - color);
    }
    return color;
  }

  void shade_row(int y, Picture& picture) const {
    for (int x = 0; x < picture.width_px; ++x) {
      const auto pixel =
          static_cast<std::size_t>(x) + static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(y);
      Color sum = Color::Zero();
      for (int s = 0; s < 4; ++s) sum += color_at(2 * x + s % 2, 2 * y + s / 2, occlusion_[pixel]);
      for (int channel = 0; channel < 3; ++channel) {
        const float value = std::pow(std::clamp(sum[channel] / 4, 0.0f, 1.0f), 1 / 2.2f);
        picture.rgb[3 * pixel + static_cast<std::size_t>(channel)] =
            static_cast<std::uint8_t>(std::lround(255 * value));
      }
    }
  }

  const Scene& scene_;
  const Layers& layers_;
  const PictureOptions& options_;
  std::array<float, 256> linear_{};
  std::vector<std::uint32_t> surface_;  ///< [samples] of the solid hit: its label, with kOnCut on the cut
  std::vector<float> depth_;            ///< [samples] mm, of the solid hit
  std::vector<float> occlusion_;        ///< [pixels]
};

}  // namespace

Picture shade(const Scene& scene, const Layers& layers, const PictureOptions& options, int threads) {
  return Shader(scene, layers, options).run(threads);
}

}  // namespace sonoloft
