#include "core/background/slice_splat.h"

#include <array>
#include <cmath>

namespace sonoloft {
namespace {

/// Two nodes along one axis and what each gets.
struct Pair {
  int low;
  double share[2];
  explicit Pair(double steps) : low(static_cast<int>(std::floor(steps))) {
    share[1] = steps - low;
    share[0] = 1 - share[1];
  }
};

void add_pixel(const Eigen::Vector3d& steps, double units, Label label, int sign, BrickTable<NodeData>& data,
               ChangedNodes& changed) {
  const Pair x(steps.x()), y(steps.y()), z(steps.z());
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
    const Eigen::Vector3i node(x.low + i, y.low + j, z.low + k);
    const auto weight = static_cast<std::int32_t>(units * x.share[i] * y.share[j] * z.share[k] + 0.5);
    if (weight == 0 || !data.nodes().contains(node)) continue;
    const std::size_t brick = data.index(brick_of(node)), at = node_index(node.x(), node.y(), node.z());
    NodeData& there = data.find_or_add(brick);
    const auto change = static_cast<std::uint32_t>(sign * weight);  // taking away is adding modulo 2^32
    there.weight[at] += change;
    if (label != kOutside) there.of_label.find_or_add(label)[at] += change;
    changed.extend(brick, Eigen::AlignedBox3i(node, node));
  }
}

}  // namespace

void splat(const NodeLattice& lattice, const Eigen::Isometry3d& image_to_reference, const SectionRaster& raster,
           int sign, BrickTable<NodeData>& data, ChangedNodes& changed) {
  const double pixel = raster.spacing_mm / lattice.spacing_mm, units = kWeightUnit * pixel * pixel;
  std::size_t at = 0;
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x, ++at) {
      if (raster.label[at] == kUnknown) continue;
      const Eigen::Vector2d p = raster.point(x, y);
      const Eigen::Vector3d steps = lattice.steps(image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
      add_pixel(steps, units, raster.label[at], sign, data, changed);
    }
}

}  // namespace sonoloft
