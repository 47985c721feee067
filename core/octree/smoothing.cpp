#include "core/octree/smoothing.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

namespace sonoloft {
namespace {

/// 1/4 of the Laplacian of the Laplacian, each of them a third of what second_differences() gives.
constexpr float kStrength = 0.25F / 9;

/// Those of four numbers of which the bit is set, else 0, whatever the number is.
Four where_set(unsigned bits, Four numbers) {
  constexpr FourInts kBits = {1, 2, 4, 8};
  return (static_cast<int>(bits) & kBits) != 0 ? numbers : Four{};
}

/// Bit x: where two rows differ.
template <class Value>
unsigned differing(const Value* a, const Value* b) {
  std::array<std::uint64_t, kBrickSize * sizeof(Value) / sizeof(std::uint64_t)> left, right;
  std::memcpy(left.data(), a, sizeof left);
  std::memcpy(right.data(), b, sizeof right);
  std::uint64_t any = 0;
  for (std::size_t i = 0; i < left.size(); ++i) any |= left[i] ^ right[i];
  unsigned bits = 0;
  for (unsigned x = 0; any != 0 && x < kBrickSize; ++x) bits |= (a[x] != b[x] ? 1u : 0u) << x;
  return bits;
}

/// The samples in which two bricks differ; all of them where the labels that occur do.
SampleMask difference(const Brick& a, const Brick& b) {
  SampleMask mask;
  const bool same_palette = a.palette == b.palette;
  for (std::size_t row = 0; row < kBrickSamples; row += kBrickSize) {
    unsigned differs = same_palette ? differing(a.label.data() + row, b.label.data() + row) : 0xFF;
    for (std::size_t r = row; same_palette && r < a.share.size(); r += kBrickSamples)
      differs |= differing(a.share.data() + r, b.share.data() + r);
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
  constexpr std::uint64_t kRow = 0xFF, kLowest = (1u << kReach) - 1;
  for (int z = -kReach; z < kBrickSize + kReach; ++z)
    for (int beside_y = -1; beside_y <= 1; ++beside_y) {
      const auto layer = [&](int x) {
        const WorkBrick* brick = around_[beside(x, beside_y, z >> 3)];
        return brick == nullptr ? 0 : brick->sampled.layer[static_cast<std::size_t>(z & 7)];
      };
      const std::uint64_t left = layer(-1) >> (kBrickSize - kReach), own = layer(0), right = layer(1);
      const int first = kBrickSize * beside_y;
      for (int y = std::max(first, -kReach); y < std::min(first + kBrickSize, kBrickSize + kReach); ++y) {
        const int shift = kBrickSize * (y - first);
        sampled_[row_index(y, z)] = static_cast<unsigned>((left >> shift & kLowest) | (own >> shift & kRow) << kReach |
                                                          (right >> shift & kLowest) << (kBrickSize + kReach));
      }
    }
}

/// The rows that matter to samples that move.
void Smoother::find_rows(const SampleMask& movable) {
  std::array<unsigned, kSide> near{}, seen{};  // [z + kReach] bit y + kReach
  for_rows(0, [&](int y, int z, std::size_t, std::size_t) {
    if (movable.row(y, z) != 0) near[static_cast<std::size_t>(z + kReach)] |= 1u << (y + kReach);
  });
  rows_.clear();
  for (std::size_t d = 0; d <= kReach; ++d) {
    for (std::size_t layer = 0; layer < kSide; ++layer)
      for (unsigned bits = near[layer] & ~seen[layer]; bits != 0; bits &= bits - 1) {
        const int y = std::countr_zero(bits) - kReach, z = static_cast<int>(layer) - kReach;
        const std::size_t row = row_index(y, z);
        const unsigned here = sampled_[row];
        if (here == 0) continue;
        Row& added = rows_.emplace_back();
        added = {row, beside(-1, y >> 3, z >> 3), static_cast<std::size_t>(sample_index(0, y & 7, z & 7)), {}, 0};
        if (d == 0) added.movable = movable.row(y, z);
        if (d == kReach) continue;
        added.both_sides = {here & here << 1 & here >> 1, here & sampled_[row - 1] & sampled_[row + 1],
                            here & sampled_[row - kSide] & sampled_[row + kSide]};
      }
    ends_[d] = rows_.size();
    seen = near;
    for (std::size_t z = 0; z < kSide; ++z) {
      near[z] |= seen[z] << 1 | seen[z] >> 1;
      if (z > 0) near[z] |= seen[z - 1];
      if (z + 1 < kSide) near[z] |= seen[z + 1];
    }
  }
}

/// What lies in rows without samples is left from earlier labels, and not taken.
void Smoother::gather_share(Label label) {
  static constexpr std::array<float, kBrickSamples> kNone{};
  std::array<const float*, 27> shares;
  for (std::size_t i = 0; i < 27; ++i) {
    shares[i] = around_[i] == nullptr ? nullptr : around_[i]->shares.find(label);
    if (shares[i] == nullptr) shares[i] = kNone.data();
  }
  for (const Row& row : rows_) {
    float* to = share_.data() + kSide * row.index;
    std::memcpy(to, shares[row.left] + row.first + kBrickSize - kReach, kReach * sizeof(float));
    std::memcpy(to + kReach, shares[row.left + 1] + row.first, kBrickSize * sizeof(float));
    std::memcpy(to + kReach + kBrickSize, shares[row.left + 2] + row.first, kReach * sizeof(float));
  }
}

/// Whether any of the shares gathered is not 0.
bool Smoother::has_share() const {
  return std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) {
    const float* share = share_.data() + kSide * row.index;
    return std::any_of(share, share + kSide, [](float s) { return s != 0.0F; });
  });
}

void Smoother::find_labels() {
  labels_.clear();
  for (const WorkBrick* brick : around_) {
    if (brick == nullptr) continue;
    for (const Label label : brick->shares.palette)
      if (const auto at = std::lower_bound(labels_.begin(), labels_.end(), label); at == labels_.end() || *at != label)
        labels_.insert(at, label);
  }
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

/// Sums (mean of both neighbours) - (sample) over the axes in which both are sampled: three times the Laplacian where
/// all are. Of four samples of a Block, which are bits shift .. shift + 3 of both_sides.
Four Smoother::second_differences(const float* at, const std::array<unsigned, 3>& both_sides, int shift) {
  constexpr std::array<std::ptrdiff_t, 3> kStep = {1, kSide, kSide * kSide};
  Four sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Four before = load_four(at - kStep[axis]), after = load_four(at + kStep[axis]);
    sum += where_set(both_sides[axis] >> shift, 0.5F * (before + after) - load_four(at));
  }
  return sum;
}

/// Moves the shares of the label that was gathered, not the first one, and the first one's the other way.
void Smoother::move(float* share, float* first_share) {
  for (std::size_t r = 0; r < ends_[1]; ++r)
    for (int x = 0; x < kSide; x += static_cast<int>(kFour)) {
      const std::size_t at = kSide * rows_[r].index + static_cast<std::size_t>(x);
      store_four(second_differences(share_.data() + at, rows_[r].both_sides, x), second_.data() + at);
    }
  for (std::size_t r = 0; r < ends_[0]; ++r)
    for (int x = 0; x < kBrickSize; x += static_cast<int>(kFour)) {
      const Row& row = rows_[r];
      const float* second = second_.data() + kSide * row.index + kReach + x;
      const Four fourth = second_differences(second, row.both_sides, x + kReach);
      const Four change = where_set(row.movable >> x, kStrength * fourth);
      const std::size_t at = row.first + static_cast<std::size_t>(x);
      store_four(load_four(share + at) - change, share + at);
      store_four(load_four(first_share + at) + change, first_share + at);
    }
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
  labels_ = brick.shares.palette;
  if (movable.any()) {
    for (std::size_t i = 0; i < 27; ++i) around_[i] = brick.around[i] == kNoBrick ? nullptr : &bricks[brick.around[i]];
    gather_sampled();
    find_rows(movable);
    find_labels();
  }
  result_.palette.clear();
  result_.share.clear();
  result_.share.reserve(labels_.size() * kBrickSamples);
  for (const Label label : labels_) {
    const float* share = brick.shares.find(label);
    const bool moves = movable.any() && label != labels_.front();
    if (moves) gather_share(label);
    if (moves && share == nullptr && !has_share()) continue;
    const std::size_t first = result_.share.size();
    result_.palette.push_back(label);
    result_.share.resize(first + kBrickSamples, 0.0F);
    if (share != nullptr) std::copy_n(share, kBrickSamples, result_.share.data() + first);
    if (moves) move(result_.share.data() + first, result_.share.data());
  }
  result_.label.fill(kNotSampled);
  name_labels(brick.sampled, result_.palette, result_.share, result_.label);
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
