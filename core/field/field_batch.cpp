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
  weight_count = 0;
}

std::uint32_t FieldBatch::add_block(std::uint32_t cell, std::uint32_t count) {
  assert(count >= 1 && !cells.constant(cell));
  constexpr std::size_t kLanes = SONOLOFT_LANES;
  const std::size_t stride = (count + kLanes - 1) / kLanes * kLanes;
  const std::size_t first_point = x.size(), slots = cells.labels(cell).size();
  const std::size_t weights = kLanes * cells.cells()[cell].face_count;
  assert(share_count + slots * stride <= std::numeric_limits<std::uint32_t>::max());
  assert(weight_count + stride / kLanes * weights <= std::numeric_limits<std::uint32_t>::max());
  for (std::vector<float>* coordinates : {&x, &y, &z}) coordinates->resize(first_point + stride);
  const auto u32 = [](std::size_t v) { return static_cast<std::uint32_t>(v); };
  for (std::size_t i = 0; i < stride; i += kLanes, weight_count += weights)
    tasks.push_back({cell, u32(first_point + i), u32(share_count + i), u32(stride), u32(weight_count)});
  blocks.push_back({cell, count, u32(first_point), u32(share_count), u32(stride)});
  share_count += slots * stride;
  return u32(blocks.size() - 1);
}

}  // namespace sonoloft
