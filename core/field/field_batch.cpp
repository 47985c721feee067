#include "core/field/field_batch.h"

#include <cassert>
#include <limits>

namespace sonoloft {

void FieldBatch::clear() {
  cells.clear();
  clear_points();
}

void FieldBatch::clear_points() {
  blocks.clear();
  tasks.clear();
  x.clear();
  y.clear();
  z.clear();
  share_count = 0;
}

std::uint32_t FieldBatch::add_points(std::uint32_t cell, std::span<const Eigen::Vector3d> points_mm) {
  assert(!points_mm.empty() && !cells.constant(cell));
  constexpr std::size_t kLanes = SONOLOFT_LANES;
  const std::size_t stride = (points_mm.size() + kLanes - 1) / kLanes * kLanes;
  const std::size_t first_point = x.size(), slots = cells.labels(cell).size();
  assert(share_count + slots * stride <= std::numeric_limits<std::uint32_t>::max());

  x.resize(first_point + stride);
  y.resize(first_point + stride);
  z.resize(first_point + stride);
  const Eigen::Vector3d& centre_mm = cells.centre_mm(cell);
  for (std::size_t i = 0; i < stride; ++i) {  // the last point fills up the last lanes
    const Eigen::Vector3f p = (points_mm[std::min(i, points_mm.size() - 1)] - centre_mm).cast<float>();
    x[first_point + i] = p.x();
    y[first_point + i] = p.y();
    z[first_point + i] = p.z();
  }
  const auto u32 = [](std::size_t v) { return static_cast<std::uint32_t>(v); };
  for (std::size_t i = 0; i < stride; i += kLanes)
    tasks.push_back({cell, u32(first_point + i), u32(share_count + i), u32(stride)});
  blocks.push_back({cell, u32(points_mm.size()), u32(first_point), u32(share_count), u32(stride)});
  share_count += slots * stride;
  return u32(blocks.size() - 1);
}

}  // namespace sonoloft
