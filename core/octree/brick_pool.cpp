#include "core/octree/brick_pool.h"

#include <algorithm>

namespace sonoloft {

float* ShareTable::row(Label label) {
  const auto it = std::lower_bound(palette.begin(), palette.end(), label);
  const auto at = it - palette.begin();
  if (it == palette.end() || *it != label) {
    palette.insert(it, label);
    share.insert(share.begin() + at * kBrickSamples, kBrickSamples, 0.0f);
  }
  return share.data() + at * kBrickSamples;
}

const float* ShareTable::find(Label label) const {
  const auto it = std::lower_bound(palette.begin(), palette.end(), label);
  if (it == palette.end() || *it != label) return nullptr;
  return share.data() + (it - palette.begin()) * kBrickSamples;
}

std::uint32_t BrickPool::find_or_add(BrickCoord coord) {
  const auto [it, added] = index_.try_emplace(coord, 0u);
  if (!added) return it->second;
  if (free_.empty()) {
    it->second = static_cast<std::uint32_t>(bricks_.size());
    bricks_.push_back(std::make_unique<WorkBrick>());
  } else {
    it->second = free_.back();
    free_.pop_back();
    *bricks_[it->second] = WorkBrick{};
  }
  WorkBrick& brick = *bricks_[it->second];
  brick.coord = brick.smooth.coord = coord;
  brick.cell.fill(kNoCell);
  brick.label.fill(kNotSampled);
  brick.smooth.label.fill(kNotSampled);
  return it->second;
}

void BrickPool::remove(std::uint32_t brick) {
  index_.erase(bricks_[brick]->coord);
  free_.push_back(brick);
}

}  // namespace sonoloft
