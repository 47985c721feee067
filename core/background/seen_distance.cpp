#include "core/background/seen_distance.h"

#include <cmath>

namespace sonoloft {
namespace {

/// Squared distances to the nearest node along one line, from those across it: the lowest of all parabolas.
/// Source: Felzenszwalb, Huttenlocher 2012, "Distance transforms of sampled functions", here by trying all in reach.
void transform_line(float* line, std::size_t length, std::size_t stride, int reach, std::vector<float>& before) {
  before.resize(length);
  for (std::size_t i = 0; i < length; ++i) before[i] = line[i * stride];
  for (std::size_t i = 0; i < length; ++i) {
    const std::size_t from = i < static_cast<std::size_t>(reach) ? 0 : i - static_cast<std::size_t>(reach);
    float nearest = before[i];
    for (std::size_t j = from; j < std::min(length, i + static_cast<std::size_t>(reach) + 1); ++j) {
      const float steps = static_cast<float>(i) - static_cast<float>(j);
      nearest = std::min(nearest, before[j] + steps * steps);
    }
    line[i * stride] = nearest;
  }
}

void transform(NodeBlock& block, int reach) {
  const auto size = (block.nodes().sizes().array() + 1).cast<std::size_t>().eval();
  std::vector<float> before;
  float* values = block.values().data();
  for (std::size_t z = 0; z < size.z(); ++z)
    for (std::size_t y = 0; y < size.y(); ++y)
      transform_line(values + size.x() * (y + size.y() * z), size.x(), 1, reach, before);
  for (std::size_t z = 0; z < size.z(); ++z)
    for (std::size_t x = 0; x < size.x(); ++x)
      transform_line(values + x + size.x() * size.y() * z, size.y(), size.x(), reach, before);
  for (std::size_t i = 0; i < size.x() * size.y(); ++i)
    transform_line(values + i, size.z(), size.x() * size.y(), reach, before);
}

}  // namespace

void distance_to_seen(const NodeLattice& lattice, const BrickTable<NodeData>& data,
                      std::span<const Eigen::Vector3d> points_mm, int reach, std::span<float> out) {
  for_each_block(lattice, points_mm, reach, [&](std::size_t first, NodeBlock& block) {
    block.clear();
    for_each_in(block.bricks(), [&](const Eigen::Vector3i& b) {
      if (const NodeData* brick = data.find(b)) block.set(b, brick->weight);
    });
    const auto far = static_cast<float>(reach * reach);
    for (float& v : block.values()) v = v >= static_cast<float>(kSeenWeight) ? 0.0f : far;
    transform(block, reach);
    for (float& v : block.values()) v = std::sqrt(v);
    block.interpolate(out.subspan(first));
  });
}

}  // namespace sonoloft
