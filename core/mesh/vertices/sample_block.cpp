#include "core/mesh/vertices/sample_block.h"

#include <algorithm>

namespace sonoloft {
namespace {

constexpr std::array<float, kBrickSamples> kNoShares{};
constexpr auto kFar = [] {
  std::array<float, kBrickSamples> far{};
  far.fill(kFarFromSlices);
  return far;
}();

/// Calls visit(source, target) for every row along x that brick `which` contributes to a block: of kBrickSize samples,
/// or of one where it lies on the upper side in x. It gives one layer where it is on the upper side in y or z.
template <class Visit>
void for_rows(unsigned which, const Visit& visit) {
  const LocalPoint upper = corner_of({0, 0, 0}, which);
  const int ny = upper.y ? 1 : kBrickSize, nz = upper.z ? 1 : kBrickSize;
  const int first = BlockGrid::index(upper.x * kBrickSize, upper.y * kBrickSize, upper.z * kBrickSize);
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y) visit(sample_index(0, y, z), first + BlockGrid::index(0, y, z));
}

}  // namespace

bool SampleBlock::select(const SampleLattice& lattice, const BrickCoord& coord) {
  used_planes_ = 0;
  shares_.clear();
  bricks_[0] = lattice.find(coord);
  if (!bricks_[0]) return false;
  for (unsigned which = 1; which < 8; ++which) {
    const LocalPoint at = corner_of({0, 0, 0}, which);
    bricks_[which] = lattice.find({coord.x + at.x, coord.y + at.y, coord.z + at.z});
    if (!bricks_[which]) continue;
    // A column of labels lies on every cache line of a brick: wait for all of them at once.
    for (std::size_t i = 0; i < kBrickSamples; i += 64 / sizeof(Label)) __builtin_prefetch(&bricks_[which]->label[i]);
  }
  BlockLabels labels;
  for (unsigned which = 0; which < 8; ++which) {
    const LocalPoint at = corner_of({0, 0, 0}, which);
    const Brick* brick = bricks_[which];
    for_rows(which, [&](int source, int target) {
      const int length = at.x ? 1 : kBrickSize;
      if (!brick)
        std::fill_n(labels.data() + target, length, kNotSampled);
      else
        std::copy_n(brick->label.data() + source, length, labels.data() + target);
    });
  }
  rows_.read(labels);
  return true;
}

const float* SampleBlock::add_gap_plane(const LabelPair& pair) {
  if (used_planes_ == planes_.size()) planes_.emplace_back();
  Plane& plane = planes_[used_planes_++];
  plane.pair = pair;
  const auto lower = shares_of(pair.lower), upper = shares_of(pair.upper);
  for (unsigned which = 0; which < 8; ++which) {
    const float *first = lower[which], *second = upper[which], *steps = slice_steps_of(which);
    for_rows(which, [&](int source, int target) {
      const unsigned asked = rows_.corners_of_mixed(target / BlockGrid::kSide) >> target % BlockGrid::kSide;
      if (asked == 0) return;
      float* gap = plane.gap.data() + target;
      if ((which & 1) != 0)
        *gap = way_to_border(first[source] - second[source], steps[source]);
      else
        for (int x = 0; x < kBrickSize; x += static_cast<int>(kFour)) {
          const int at = source + x;
          store_four(way_to_border(load_four(first + at) - load_four(second + at), load_four(steps + at)), gap + x);
        }
    });
  }
  return plane.gap.data();
}

void SampleBlock::find_shares(LocalPoint cell, CellSamples& samples) {
  std::array<std::size_t, 8> brick, sample;
  for (unsigned c = 0; c < 8; ++c) {
    const LocalPoint at = corner_of(cell, c);
    brick[c] = static_cast<std::size_t>(at.x >> 3 | at.y >> 3 << 1 | at.z >> 3 << 2);
    sample[c] = static_cast<std::size_t>(sample_index(at.x & 7, at.y & 7, at.z & 7));
    samples.slice_steps[c] = slice_steps_of(brick[c])[sample[c]];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples.label_count); ++i) {
    const auto& shares = shares_of(samples.label[i]);
    for (std::size_t c = 0; c < 8; ++c) samples.share[i][c] = shares[brick[c]][sample[c]];
  }
}

const std::array<const float*, 8>& SampleBlock::shares_of(Label label) {
  const auto known = std::ranges::find(shares_, label, &Shares::label);
  if (known != shares_.end()) return known->of_brick;
  Shares& added = shares_.emplace_back(Shares{label, {}});
  for (std::size_t which = 0; which < 8; ++which) {
    added.of_brick[which] = kNoShares.data();
    const Brick* brick = bricks_[which];
    if (!brick) continue;
    const auto found = std::ranges::lower_bound(brick->palette, label);
    if (found != brick->palette.end() && *found == label)
      added.of_brick[which] = brick->share.data() + (found - brick->palette.begin()) * kBrickSamples;
  }
  return added.of_brick;
}

const float* SampleBlock::slice_steps_of(std::size_t which) const {
  const Brick* brick = bricks_[which];
  return brick && !brick->slice_steps.empty() ? brick->slice_steps.data() : kFar.data();
}

}  // namespace sonoloft
