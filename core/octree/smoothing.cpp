#include "core/octree/smoothing.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

namespace sonoloft {
namespace {

constexpr int kReach = 2;
constexpr int kSide = kBrickSize + 2 * kReach;
constexpr int kBlock = kSide * kSide * kSide;
constexpr int kStep[3] = {1, kSide, kSide* kSide};
constexpr float kStrength = 0.25f;

/// A value for each sample of the brick and of the two layers around it.
using Block = std::array<float, kBlock>;

constexpr std::size_t block_index(int x, int y, int z) {
  return static_cast<std::size_t>((x + kReach) + kSide * ((y + kReach) + kSide * (z + kReach)));
}

/// The brick and the 26 around it.
class Neighbourhood {
 public:
  Neighbourhood(const BrickPool& bricks, const WorkBrick& middle) {
    for (std::size_t i = 0; i < 27; ++i)
      around_[i] = middle.around[i] == kNoBrick ? nullptr : &bricks[middle.around[i]];
  }

  [[nodiscard]] std::vector<Label> labels() const {
    std::vector<Label> all;
    for (const WorkBrick* brick : around_)
      if (brick != nullptr) all.insert(all.end(), brick->shares.palette.begin(), brick->shares.palette.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  /// 1 where a sample was taken, else 0.
  void gather_sampled(Block& out) const {
    for_rows([&](std::size_t brick, int first, int count, int y, int z, std::size_t to) {
      for (int x = first; x < first + count; ++x, ++to)
        out[to] = around_[brick] != nullptr && around_[brick]->sampled.test(sample_index(x, y, z)) ? 1.0f : 0.0f;
    });
  }

  void gather_share(Label label, Block& out) const {
    std::array<const float*, 27> rows;
    for (std::size_t i = 0; i < 27; ++i) rows[i] = around_[i] == nullptr ? nullptr : around_[i]->shares.find(label);
    for_rows([&](std::size_t brick, int first, int count, int y, int z, std::size_t to) {
      if (rows[brick] == nullptr)
        std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(to), count, 0.0f);
      else
        std::copy_n(rows[brick] + sample_index(first, y, z), count, out.begin() + static_cast<std::ptrdiff_t>(to));
    });
  }

 private:
  /// Calls visit(brick of around_, first x, count, y, z in it, index in the block) for each piece of each row.
  template <class Visit>
  static void for_rows(Visit visit) {
    for (int z = -kReach; z < kBrickSize + kReach; ++z)
      for (int y = -kReach; y < kBrickSize + kReach; ++y) {
        const auto brick = static_cast<std::size_t>(3 * ((y >> 3) + 1) + 9 * ((z >> 3) + 1));
        visit(brick, kBrickSize - kReach, kReach, y & 7, z & 7, block_index(-kReach, y, z));
        visit(brick + 1, 0, kBrickSize, y & 7, z & 7, block_index(0, y, z));
        visit(brick + 2, 0, kReach, y & 7, z & 7, block_index(kBrickSize, y, z));
      }
  }

  std::array<const WorkBrick*, 27> around_;
};

/// 1 for the samples, one step outside of the brick at most, whose eight finest cells are sampled. Only these may
/// change: an edge that a change makes mixed then has its four cells.
Block find_inner(const Block& sampled) {
  Block inner = sampled;
  for (const int step : kStep) {
    const Block before = inner;
    const auto s = static_cast<std::size_t>(step);
    for (std::size_t at = s; at < kBlock - s; ++at) inner[at] = before[at] * before[at - s] * before[at + s];
  }
  return inner;
}

float laplacian(const Block& f, std::size_t at) {
  const float sum =
      f[at - kStep[0]] + f[at + kStep[0]] + f[at - kStep[1]] + f[at + kStep[1]] + f[at - kStep[2]] + f[at + kStep[2]];
  return sum * (1.0f / 6.0f) - f[at];
}

/// Moves the shares of one brick.
class Mover {
 public:
  Mover(const BrickPool& bricks, const WorkBrick& brick) : around_(bricks, brick), labels_(around_.labels()) {
    Block sampled;
    around_.gather_sampled(sampled);
    inner_ = find_inner(sampled);
    for (int i = 0; i < kBrickSamples; ++i)
      strength_[static_cast<std::size_t>(i)] =
          brick.pinned.test(i) ? 0.0F : kStrength * inner_[block_index(i & 7, (i >> 3) & 7, i >> 6)];
  }

  [[nodiscard]] const std::vector<Label>& labels() const { return labels_; }

  /// Moves the shares of a label and subtracts the change from `left`.
  void move(Label label, float* share, std::array<float, kBrickSamples>& left) {
    Block f, lf;
    around_.gather_share(label, f);
    for (std::size_t at = kStep[2]; at < kBlock - kStep[2]; ++at)  // nothing is used of the outermost layer
      lf[at] = inner_[at] * laplacian(f, at);
    for (std::size_t i = 0; i < kBrickSamples; i += kBrickSize) {
      const std::size_t block = block_index(0, static_cast<int>(i >> 3 & 7), static_cast<int>(i >> 6));
      for (std::size_t x = 0; x < kBrickSize; ++x) {
        const float change = strength_[i + x] * laplacian(lf, block + x);
        share[i + x] -= change;
        left[i + x] -= change;
      }
    }
  }

 private:
  Neighbourhood around_;
  std::vector<Label> labels_;
  Block inner_;
  std::array<float, kBrickSamples> strength_;  ///< of smoothing, sample by sample
};

/// Clears what was not sampled and names the label with the largest share, the lowest of equals.
void finish(const SampleMask& sampled, Brick& brick) {
  std::array<float, kBrickSamples> best, taken;
  for (int i = 0; i < kBrickSamples; ++i) {
    const bool is_sampled = sampled.test(i);
    taken[static_cast<std::size_t>(i)] = is_sampled ? 1.0F : 0.0F;
    best[static_cast<std::size_t>(i)] = is_sampled ? -2.0F : std::numeric_limits<float>::infinity();
  }
  brick.label.fill(kNotSampled);
  for (std::size_t row = 0; row < brick.palette.size(); ++row) {
    float* share = brick.share.data() + row * kBrickSamples;
    for (std::size_t i = 0; i < kBrickSamples; ++i) {
      share[i] *= taken[i];
      if (share[i] > best[i]) {
        best[i] = share[i];
        brick.label[i] = brick.palette[row];
      }
    }
  }
}

/// The samples in which two bricks differ; all of them where the labels that occur do.
SampleMask difference(const Brick& a, const Brick& b) {
  SampleMask mask;
  std::array<std::uint32_t, kBrickSamples> differs{};
  const bool same_palette = a.palette == b.palette;
  for (std::size_t i = 0; i < kBrickSamples; ++i) differs[i] = !same_palette || a.label[i] != b.label[i];
  for (std::size_t row = 0; same_palette && row < a.palette.size(); ++row)
    for (std::size_t i = 0; i < kBrickSamples; ++i)
      differs[i] |= a.share[row * kBrickSamples + i] != b.share[row * kBrickSamples + i];
  for (std::size_t i = 0; i < kBrickSamples; ++i)
    if (differs[i] != 0) mask.set(static_cast<int>(i));
  return mask;
}

}  // namespace

SampleMask smooth_brick(const BrickPool& bricks, WorkBrick& brick) {
  Brick result;
  result.coord = brick.coord;
  result.palette = brick.shares.palette;
  std::optional<Mover> mover;
  if ((brick.sampled - brick.pinned).any()) {
    mover.emplace(bricks, brick);
    result.palette = mover->labels();
  }
  result.share.assign(result.palette.size() * kBrickSamples, 0.0F);
  std::array<float, kBrickSamples> left{};  // of the changes of all labels but the first
  for (std::size_t row = result.palette.size(); row-- > 0;) {
    float* out = result.share.data() + row * kBrickSamples;
    if (const float* share = brick.shares.find(result.palette[row])) std::copy_n(share, kBrickSamples, out);
    if (row == 0)
      for (std::size_t i = 0; i < kBrickSamples; ++i) out[i] -= left[i];
    else if (mover)
      mover->move(result.palette[row], out, left);
  }
  finish(brick.sampled, result);
  const SampleMask changed = difference(result, brick.smooth);
  if (!changed.any()) return changed;
  result.unmeasured = std::move(brick.smooth.unmeasured);
  brick.smooth = std::move(result);
  return changed;
}

}  // namespace sonoloft
