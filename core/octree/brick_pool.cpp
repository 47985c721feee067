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
  const std::uint32_t index = it->second;
  WorkBrick& brick = *bricks_[index];
  brick.coord = brick.smooth.coord = coord;
  for (int i = 0; i < 27; ++i)
    brick.around[static_cast<std::size_t>(i)] =
        find({coord.x + i % 3 - 1, coord.y + i / 3 % 3 - 1, coord.z + i / 9 - 1});
  name_to_neighbours(brick, index);
  brick.cell.fill(kNoCell);
  brick.label.fill(kNotSampled);
  brick.smooth.label.fill(kNotSampled);
  return index;
}

std::vector<std::uint32_t> BrickPool::indices() const {
  std::vector<std::uint32_t> all;
  for (const auto& [coord, index] : index_) all.push_back(index);
  std::sort(all.begin(), all.end());
  return all;
}

void BrickPool::name_to_neighbours(const WorkBrick& brick, std::uint32_t name) {
  for (std::size_t i = 0; i < 27; ++i)  // seen from there it lies on the opposite side
    if (const std::uint32_t there = brick.around[i]; there != kNoBrick) bricks_[there]->around[26 - i] = name;
}

void BrickPool::remove(std::uint32_t brick) {
  name_to_neighbours(*bricks_[brick], kNoBrick);
  index_.erase(bricks_[brick]->coord);
  free_.push_back(brick);
}

}  // namespace sonoloft
