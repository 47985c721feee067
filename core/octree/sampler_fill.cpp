// What Sampler takes for the part of a sample that no slice measured.
#include <algorithm>

#include "core/octree/sampler.h"

namespace sonoloft {

/// f = known shares + unmeasured share * what fills it (docs/pipeline/9-background.md).
void Sampler::fill_unmeasured(WorkBrick& brick, const Group& group, Scratch& scratch) const {
  const std::span<const std::uint16_t> index = samples_of(group);
  PointShares& filling = scratch.filling;
  positions_mm(axes_mm(brick.coord), index, scratch.points_mm);
  scratch.filled.clear();
  for (const std::uint16_t i : index) scratch.filled.push_back(brick.smooth.unmeasured[i]);
  fill_from_rims(brick, group, scratch);
  if (fill_.shares) {
    fill_.shares(sampled_.cell(group.packed), scratch.points_mm, filling);
  } else {
    filling.labels.assign(1, kOutside);
    filling.share.assign(index.size(), 1.0f);
  }
  for (std::size_t l = 0; l < filling.labels.size(); ++l) {
    const float* share = filling.share.data() + l * index.size();
    float* row = brick.shares.row(filling.labels[l]);
    for (std::size_t k = 0; k < index.size(); ++k) row[index[k]] += scratch.filled[k] * share[k];
  }
}

/// In the unknown part of a wall a rim weighs its labels against the rest: these get B / (1 + sum of B) of it.
void Sampler::fill_from_rims(WorkBrick& brick, const Group& group, Scratch& scratch) const {
  const std::span<const std::uint16_t> index = samples_of(group);
  const std::span<const Rim* const> rims = sampled_.rims(group.packed);
  const std::size_t first_slot = batch_.cells.labels(group.packed).size() - rims.size();
  for (std::size_t r = 0; r < rims.size(); ++r) {
    PointWeights& rim = scratch.rim;
    rims[r]->weigh(scratch.points_mm, rim);
    const float* share = shares(group, first_slot + r);
    for (std::size_t k = 0; k < index.size(); ++k) {
      float total = 1;
      for (std::size_t i = k; i < rim.weight.size(); i += index.size()) total += rim.weight[i];
      const float each = share[k] / total;
      for (std::size_t i = k; i < rim.weight.size(); i += index.size()) rim.weight[i] *= each;
      scratch.filled[k] -= each * (total - 1);
    }
    for (std::size_t l = 0; l < rim.labels.size(); ++l) {
      float* row = brick.shares.row(rim.labels[l]);
      for (std::size_t k = 0; k < index.size(); ++k) row[index[k]] += rim.weight[l * index.size() + k];
    }
  }
  for (float& share : scratch.filled) share = std::max(share, 0.0f);  // below by rounding
}

}  // namespace sonoloft
