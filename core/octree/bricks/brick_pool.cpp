#include "core/octree/bricks/brick_pool.h"

#include <algorithm>

#include "core/slice/four.h"

namespace sonoloft {
namespace {

/// The bricks around one, those first that know most of the others.
constexpr std::array<int, 26> kFacesFirst = {4,  10, 12, 14, 16, 22, 1, 3, 5, 7,  9,  11, 15,
                                             17, 19, 21, 23, 25, 0,  2, 6, 8, 18, 20, 24, 26};

}  // namespace

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

void name_labels(const SampleMask& samples, std::span<const Label> palette, std::span<const float> share,
                 std::span<Label, kBrickSamples> label) {
  for (std::size_t row = 0; row < kBrickSamples; row += kBrickSize) {
    unsigned bits = static_cast<unsigned>(samples.layer[row >> 6] >> (row & 63) & 0xFF);
    if (bits == 0) continue;
    const auto half_row = [&](std::size_t first) {
      Four best = load_four(share.data() + first);
      FourInts largest{};  // index in the palette
      for (std::size_t r = 1; r < palette.size(); ++r) {
        const Four other = load_four(share.data() + r * kBrickSamples + first);
        const FourInts above = other > best;
        largest = above ? FourInts{} + static_cast<int>(r) : largest;
        best = above ? other : best;
      }
      return largest;
    };
    const std::array<FourInts, 2> largest = {half_row(row), half_row(row + kFour)};
    for (; bits != 0; bits &= bits - 1) {
      const auto x = static_cast<std::size_t>(std::countr_zero(bits));
      label[row + x] = palette[static_cast<std::size_t>(largest[x / kFour][x % kFour])];
    }
  }
}

bool WorkBrick::add(std::uint32_t cell, const SampleMask& samples) {
  sampled = sampled | samples;
  const auto known =
      std::find_if(in_cells.begin(), in_cells.end(), [&](const SamplesInCell& in) { return in.cell == cell; });
  if (known == in_cells.end()) {
    in_cells.push_back({cell, samples});
    return true;
  }
  known->samples = known->samples | samples;
  return false;
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
  find_around(brick);
  brick.around[beside(0, 0, 0)] = index;
  name_to_neighbours(brick, index);
  brick.label.fill(kNotSampled);
  brick.smooth.label.fill(kNotSampled);
  return index;
}

/// A neighbour that was found knows the bricks that lie around both.
void BrickPool::find_around(WorkBrick& brick) const {
  constexpr std::uint32_t kNotSought = kNoBrick - 1;
  brick.around.fill(kNotSought);
  for (const int i : kFacesFirst) {
    const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
    std::uint32_t& there = brick.around[static_cast<std::size_t>(i)];
    if (there != kNotSought) continue;
    there = find({brick.coord.x + x, brick.coord.y + y, brick.coord.z + z});
    if (there == kNoBrick) continue;
    const WorkBrick& known = *bricks_[there];
    for (int w = std::max(z - 1, -1); w <= std::min(z + 1, 1); ++w)
      for (int v = std::max(y - 1, -1); v <= std::min(y + 1, 1); ++v)
        for (int u = std::max(x - 1, -1); u <= std::min(x + 1, 1); ++u)
          brick.around[beside(u, v, w)] = known.around[beside(u - x, v - y, w - z)];
  }
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
