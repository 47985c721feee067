#include "host/apps/picture/raster.h"

#include <algorithm>
#include <cmath>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr int kBandRows = 32;

/// Twice the area of (a, b, p). Exact: all coordinates are multiples of 2^-9 below 2^21.
double edge(const Projected& a, const Projected& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

struct Rows {
  int first, last;  ///< [first, last)
};

/// The sample rows that may lie within a triangle; none if it cannot be drawn.
Rows rows_of(const Scene& scene, std::size_t triangle) {
  const auto& t = scene.mesh.triangles[triangle];
  const Projected &a = scene.projected[t[0]], &b = scene.projected[t[1]], &c = scene.projected[t[2]];
  if (std::min({a.inverse_depth, b.inverse_depth, c.inverse_depth}) <= 0) return {0, 0};
  const auto [low, high] = std::minmax({a.y, b.y, c.y});
  return {std::clamp(static_cast<int>(std::ceil(low - 0.5)), 0, scene.camera.height),
          std::clamp(static_cast<int>(std::floor(high - 0.5)) + 1, 0, scene.camera.height)};
}

/// Triangles by band of rows, ascending within each: those of band b are index[first[b]] .. index[first[b + 1]].
struct Bands {
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> index;
};

Bands sort_into_bands(const Scene& scene) {
  const auto count = static_cast<std::size_t>((scene.camera.height + kBandRows - 1) / kBandRows);
  Bands bands{std::vector<std::size_t>(count + 1), {}};
  const auto each = [&](auto&& visit) {
    for (std::size_t t = 0; t < scene.mesh.triangles.size(); ++t) {
      const Rows rows = rows_of(scene, t);
      if (rows.first >= rows.last) continue;
      for (int band = rows.first / kBandRows; band <= (rows.last - 1) / kBandRows; ++band) {
        visit(static_cast<std::size_t>(band), static_cast<std::uint32_t>(t));
      }
    }
  };
  each([&](std::size_t band, std::uint32_t) { ++bands.first[band + 1]; });
  for (std::size_t b = 0; b < count; ++b) bands.first[b + 1] += bands.first[b];
  bands.index.resize(bands.first.back());
  auto next = bands.first;
  each([&](std::size_t band, std::uint32_t t) { bands.index[next[band]++] = t; });
  return bands;
}

void draw_triangle(const Scene& scene, std::uint32_t triangle, int first_row, int last_row, Layers& layers) {
  const auto& t = scene.mesh.triangles[triangle];
  const Projected &a = scene.projected[t[0]], &b = scene.projected[t[1]], &c = scene.projected[t[2]];
  const double area = edge(a, b, c.x, c.y);
  if (area == 0) return;
  const bool facing = scene.face_normal[triangle].dot(scene.view[t[0]]) < 0;
  Layer& layer = seen(scene, triangle, facing).glass ? layers.glass : layers.solid;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const int first_column = std::max(0, static_cast<int>(std::ceil(left - 0.5)));
  const int last_column = std::min(scene.camera.width, static_cast<int>(std::floor(right - 0.5)) + 1);
  const double sign = area > 0 ? 1.0 : -1.0;
  const double to_a = a.inverse_depth / std::abs(area), to_b = b.inverse_depth / std::abs(area),
               to_c = c.inverse_depth / std::abs(area);
  for (int row = first_row; row < last_row; ++row) {
    for (int column = first_column; column < last_column; ++column) {
      const double x = column + 0.5, y = row + 0.5;
      const double in_a = sign * edge(b, c, x, y), in_b = sign * edge(c, a, x, y), in_c = sign * edge(a, b, x, y);
      if (in_a < 0 || in_b < 0 || in_c < 0) continue;
      const auto inverse_depth = static_cast<float>(in_a * to_a + in_b * to_b + in_c * to_c);
      const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(scene.camera.width) +
                      static_cast<std::size_t>(column);
      if (inverse_depth <= layer.inverse_depth[at]) continue;
      if (scene.cut && scene.cut->removes(scene.camera.ray(column, row) / inverse_depth)) continue;
      layer.inverse_depth[at] = inverse_depth;
      layer.triangle[at] = triangle;
    }
  }
}

}  // namespace

Seen seen(const Scene& scene, std::size_t triangle, bool to_eye) {
  const Label front = scene.mesh.label_front[triangle], back = scene.mesh.label_back[triangle];
  const Label near = to_eye ? front : back, far = to_eye ? back : front;
  const auto solid = [&](Label label) { return label != kOutside && !scene.glass[label]; };
  if (solid(far)) return {near, far, far, false};
  if (solid(near)) return {near, far, near, false};
  return {near, far, far != kOutside ? far : near, true};
}

Eigen::Vector3f weights(const Scene& scene, std::size_t triangle, int column, int row) {
  const auto& t = scene.mesh.triangles[triangle];
  const Projected &a = scene.projected[t[0]], &b = scene.projected[t[1]], &c = scene.projected[t[2]];
  const double x = column + 0.5, y = row + 0.5;
  const Eigen::Vector3d w(edge(b, c, x, y) * a.inverse_depth, edge(c, a, x, y) * b.inverse_depth,
                          edge(a, b, x, y) * c.inverse_depth);
  return (w / w.sum()).cast<float>();
}

Layers rasterise(const Scene& scene, int threads) {
  const auto samples = static_cast<std::size_t>(scene.camera.width) * static_cast<std::size_t>(scene.camera.height);
  const Layer empty{std::vector<std::uint32_t>(samples, kNoTriangle), std::vector<float>(samples, 0.0f)};
  Layers layers{empty, empty};
  const Bands bands = sort_into_bands(scene);
  parallel_for(bands.first.size() - 1, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t band = first; band < last; ++band) {
      const int band_row = static_cast<int>(band) * kBandRows;
      for (std::size_t i = bands.first[band]; i < bands.first[band + 1]; ++i) {
        const Rows rows = rows_of(scene, bands.index[i]);
        draw_triangle(scene, bands.index[i], std::max(rows.first, band_row), std::min(rows.last, band_row + kBandRows),
                      layers);
      }
    }
  });
  return layers;
}

}  // namespace sonoloft
