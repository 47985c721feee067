#include "core/octree/bricks/brick_pool.h"

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

void ShareTable::drop_empty_rows() {
  for (std::size_t row = palette.size(); row-- > 0;) {
    const auto first = share.begin() + static_cast<std::ptrdiff_t>(row * kBrickSamples), last = first + kBrickSamples;
    if (std::any_of(first, last, [](float s) { return s != 0.0F; })) continue;
    share.erase(first, last);
    palette.erase(palette.begin() + static_cast<std::ptrdiff_t>(row));
  }
}

void WorkBrick::add(std::uint32_t cell, const SampleMask& samples) {
  sampled = sampled | samples;
  const auto known =
      std::find_if(in_cells.begin(), in_cells.end(), [&](const SamplesInCell& in) { return in.cell == cell; });
  if (known == in_cells.end())
    in_cells.push_back({cell, samples});
  else
    known->samples = known->samples | samples;
}

void WorkBrick::forget(const SampleMask& samples) {
  sampled = sampled - samples;
  pinned = pinned - samples;
  for (SamplesInCell& in : in_cells) in.samples = in.samples - samples;
  std::erase_if(in_cells, [](const SamplesInCell& in) { return !in.samples.any(); });
  samples.for_each([&](int i) {
    label[static_cast<std::size_t>(i)] = kNotSampled;
    for (std::size_t row = 0; row < shares.palette.size(); ++row)
      shares.share[row * kBrickSamples + static_cast<std::size_t>(i)] = 0.0F;
    if (!smooth.unmeasured.empty()) smooth.unmeasured[static_cast<std::size_t>(i)] = 0.0F;
  });
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
