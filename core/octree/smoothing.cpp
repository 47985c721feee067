#include "core/octree/smoothing.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace sonoloft {
namespace {

/// 1/4 of the Laplacian of the Laplacian, each of them a third of what second_differences() gives.
constexpr float kStrength = 0.25F / 9;

/// 1 for each of eight bits that is set.
constexpr auto kOnes = [] {
  std::array<std::array<float, 8>, 256> ones{};
  for (unsigned bits = 0; bits < 256; ++bits)
    for (unsigned i = 0; i < 8; ++i) ones[bits][i] = (bits >> i & 1) != 0 ? 1.0F : 0.0F;
  return ones;
}();

/// Names the label with the largest share, the lowest of equals.
void name_labels(const SampleMask& sampled, Brick& brick) {
  brick.label.fill(kNotSampled);
  for (int row = 0; row < kBrickSamples; row += kBrickSize) {
    const unsigned bits = sampled.row(row >> 3 & 7, row >> 6);
    if (bits == 0) continue;
    std::array<float, kBrickSize> best;
    best.fill(-2.0F);
    Label* label = brick.label.data() + row;
    for (std::size_t r = 0; r < brick.palette.size(); ++r) {
      const float* share = brick.share.data() + r * kBrickSamples + row;
      for (std::size_t x = 0; x < kBrickSize; ++x) {
        label[x] = share[x] > best[x] ? brick.palette[r] : label[x];
        best[x] = share[x] > best[x] ? share[x] : best[x];
      }
    }
    for (std::size_t x = 0; x < kBrickSize; ++x)
      if ((bits >> x & 1) == 0) label[x] = kNotSampled;
  }
}

/// The samples in which two bricks differ; all of them where the labels that occur do.
SampleMask difference(const Brick& a, const Brick& b) {
  SampleMask mask;
  const bool same_palette = a.palette == b.palette;
  for (std::size_t row = 0; row < kBrickSamples; row += kBrickSize) {
    unsigned differs = same_palette ? 0 : 0xFF;
    const auto compare = [&](const auto* left, const auto* right) {
      if (std::memcmp(left, right, kBrickSize * sizeof *left) == 0) return;
      for (unsigned x = 0; x < kBrickSize; ++x) differs |= (left[x] != right[x] ? 1u : 0u) << x;
    };
    compare(a.label.data() + row, b.label.data() + row);
    for (std::size_t r = 0; same_palette && r < a.palette.size(); ++r)
      compare(a.share.data() + r * kBrickSamples + row, b.share.data() + r * kBrickSamples + row);
    mask.layer[row >> 6] |= std::uint64_t{differs} << (row & 63);
  }
  return mask;
}

}  // namespace

/// The row of samples at (y, z) of the brick, each -kReach .. kBrickSize + kReach - 1.
std::size_t Smoother::row_index(int y, int z) {
  return static_cast<std::size_t>((y + kReach) + kSide * (z + kReach));
}

/// Calls visit(y, z, index of the row, index in Around of the brick at x = -1 there) for the rows of the brick and of
/// `margin` layers around it.
template <class Visit>
void Smoother::for_rows(int margin, Visit visit) {
  for (int z = -margin; z < kBrickSize + margin; ++z)
    for (int y = -margin; y < kBrickSize + margin; ++y) visit(y, z, row_index(y, z), beside(-1, y >> 3, z >> 3));
}

void Smoother::gather_sampled() {
  for_rows(kReach, [&](int y, int z, std::size_t row, std::size_t left) {
    const auto bits = [&](std::size_t brick) {
      return around_[brick] == nullptr ? 0u : around_[brick]->sampled.row(y & 7, z & 7);
    };
    constexpr unsigned kLowest = (1u << kReach) - 1;
    sampled_[row] = bits(left) >> (kBrickSize - kReach) | bits(left + 1) << kReach |
                    (bits(left + 2) & kLowest) << (kBrickSize + kReach);
  });
}

void Smoother::gather_share(Label label) {
  static constexpr std::array<float, kBrickSamples> kNone{};
  std::array<const float*, 27> shares;
  for (std::size_t i = 0; i < 27; ++i) {
    shares[i] = around_[i] == nullptr ? nullptr : around_[i]->shares.find(label);
    if (shares[i] == nullptr) shares[i] = kNone.data();
  }
  for_rows(kReach, [&](int y, int z, std::size_t row, std::size_t left) {
    const int first = sample_index(0, y & 7, z & 7);
    float* to = share_.data() + kSide * row;
    to = std::copy_n(shares[left] + first + kBrickSize - kReach, kReach, to);
    to = std::copy_n(shares[left + 1] + first, kBrickSize, to);
    std::copy_n(shares[left + 2] + first, kReach, to);
  });
}

/// All labels with a share here, ascending.
std::vector<Label> Smoother::labels_around() const {
  std::vector<Label> all;
  for (const WorkBrick* brick : around_) {
    if (brick == nullptr) continue;
    for (const Label label : brick->shares.palette)
      if (const auto at = std::lower_bound(all.begin(), all.end(), label); at == all.end() || *at != label)
        all.insert(at, label);
  }
  return all;
}

/// The samples of the brick whose eight finest cells are sampled. Only these may change their label: an edge that a
/// change makes mixed then has its four cells.
SampleMask Smoother::inner() const {
  SampleMask inner;
  for_rows(0, [&](int y, int z, std::size_t row, std::size_t) {
    unsigned all = ~0u;
    for (const std::size_t layer : {row - kSide, row, row + kSide})
      all &= sampled_[layer - 1] & sampled_[layer] & sampled_[layer + 1];
    all &= all << 1 & all >> 1;
    inner.layer[static_cast<std::size_t>(z)] |= std::uint64_t{all >> kReach & 0xFF} << (8 * y);
  });
  return inner;
}

/// 1 for each bit of a row that is set.
Smoother::Row Smoother::ones(unsigned bits) {
  Row row;
  const auto rest = std::copy_n(kOnes[bits & 0xFF].begin(), 8, row.begin());
  std::copy_n(kOnes[bits >> 8].begin(), kSide - 8, rest);
  return row;
}

/// Sums (mean of both neighbours) - (sample) over the axes in which both are sampled: three times the Laplacian where
/// all are. Of one row, not one on the outside.
Smoother::Row Smoother::second_differences(const Block& f, std::size_t row) const {
  constexpr std::array<std::size_t, 3> kStep = {1, kSide, kSide * kSide};
  Row sum{};
  const unsigned here = sampled_[row];
  if (here == 0) return sum;
  const std::array<unsigned, 3> both = {here & here << 1 & here >> 1, here & sampled_[row - 1] & sampled_[row + 1],
                                        here & sampled_[row - kSide] & sampled_[row + kSide]};
  const float* at = f.data() + kSide * row;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float *before = at - kStep[axis], *after = at + kStep[axis];
    const Row counts = ones(both[axis]);
    for (std::size_t x = 0; x < kSide; ++x) sum[x] += counts[x] * (0.5F * (before[x] + after[x]) - at[x]);
  }
  return sum;
}

/// Moves the shares of a label that is not the first one, and the first one's the other way.
void Smoother::move(Label label, const SampleMask& movable, float* share, float* first_share) {
  gather_share(label);
  for_rows(1, [&](int, int, std::size_t row, std::size_t) {
    const Row second = second_differences(share_, row);
    std::copy(second.begin(), second.end(), second_.begin() + static_cast<std::ptrdiff_t>(kSide * row));
  });
  for_rows(0, [&](int y, int z, std::size_t row, std::size_t) {
    const unsigned bits = movable.row(y, z);
    if (bits == 0) return;
    const Row fourth = second_differences(second_, row);
    const std::array<float, kBrickSize>& moves = kOnes[bits];
    const auto first = static_cast<std::size_t>(sample_index(0, y, z));
    for (std::size_t x = 0; x < kBrickSize; ++x) {
      const float change = kStrength * moves[x] * fourth[x + kReach];
      share[first + x] -= change;
      first_share[first + x] += change;
    }
  });
}

/// Puts samples back whose label changed.
void Smoother::keep_labels(const WorkBrick& brick, const SampleMask& samples) {
  samples.for_each([&](int i) {
    const auto at = static_cast<std::size_t>(i);
    if (result_.label[at] == brick.label[at]) return;
    result_.label[at] = brick.label[at];
    for (std::size_t row = 0; row < result_.palette.size(); ++row) {
      const float* share = brick.shares.find(result_.palette[row]);
      result_.share[row * kBrickSamples + at] = share == nullptr ? 0.0F : share[at];
    }
  });
}

SampleMask Smoother::smooth(const BrickPool& bricks, WorkBrick& brick) {
  const SampleMask movable = brick.sampled - brick.pinned;
  result_.coord = brick.coord;
  result_.palette = brick.shares.palette;
  if (movable.any()) {
    for (std::size_t i = 0; i < 27; ++i) around_[i] = brick.around[i] == kNoBrick ? nullptr : &bricks[brick.around[i]];
    gather_sampled();
    result_.palette = labels_around();
  }
  result_.share.assign(result_.palette.size() * kBrickSamples, 0.0F);
  for (std::size_t row = 0; row < result_.palette.size(); ++row) {
    float* out = result_.share.data() + row * kBrickSamples;
    if (const float* share = brick.shares.find(result_.palette[row])) std::copy_n(share, kBrickSamples, out);
    if (row > 0 && movable.any()) move(result_.palette[row], movable, out, result_.share.data());
  }
  name_labels(brick.sampled, result_);
  if (movable.any()) keep_labels(brick, movable - inner());
  const SampleMask changed = difference(result_, brick.smooth) | (brick.slices_moved & brick.sampled);
  brick.slices_moved = {};
  if (!changed.any()) return changed;
  std::swap(result_, brick.smooth);
  std::swap(result_.unmeasured, brick.smooth.unmeasured);  // stay with the brick
  std::swap(result_.slice_steps, brick.smooth.slice_steps);
  return changed;
}

}  // namespace sonoloft
