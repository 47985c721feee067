#include "core/octree/smoothing.h"

#include <algorithm>
#include <array>
#include <limits>

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
    for (int i = 0; i < 27; ++i) {
      const BrickCoord c{middle.coord.x + i % 3 - 1, middle.coord.y + i / 3 % 3 - 1, middle.coord.z + i / 9 - 1};
      const std::uint32_t brick = bricks.find(c);
      around_[static_cast<std::size_t>(i)] = brick == kNoBrick ? nullptr : &bricks[brick];
    }
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

}  // namespace

bool smooth_brick(const BrickPool& bricks, WorkBrick& brick) {
  const Neighbourhood around(bricks, brick);
  Block sampled;
  around.gather_sampled(sampled);
  const Block inner = find_inner(sampled);
  std::array<float, kBrickSamples> strength;  // of smoothing, sample by sample
  std::array<float, kBrickSamples> best;
  for (int i = 0; i < kBrickSamples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const std::size_t block = block_index(i & 7, (i >> 3) & 7, i >> 6);
    strength[at] = brick.pinned.test(i) ? 0.0f : kStrength * inner[block];
    best[at] = sampled[block] > 0.0f ? -2.0f : std::numeric_limits<float>::infinity();
  }

  Brick result;
  result.coord = brick.coord;
  result.palette = around.labels();
  result.share.resize(result.palette.size() * kBrickSamples);
  result.label.fill(kNotSampled);
  Block f;
  Block lf;
  for (std::size_t row = 0; row < result.palette.size(); ++row) {
    around.gather_share(result.palette[row], f);
    for (std::size_t at = kStep[2]; at < kBlock - kStep[2]; ++at)  // nothing is used of the outermost layer
      lf[at] = inner[at] * laplacian(f, at);
    float* out = result.share.data() + row * kBrickSamples;
    for (std::size_t i = 0; i < kBrickSamples; i += kBrickSize) {
      const std::size_t block = block_index(0, static_cast<int>(i >> 3 & 7), static_cast<int>(i >> 6));
      for (std::size_t x = 0; x < kBrickSize; ++x)
        out[i + x] = sampled[block + x] * (f[block + x] - strength[i + x] * laplacian(lf, block + x));
    }
    for (std::size_t i = 0; i < kBrickSamples; ++i)
      if (out[i] > best[i]) {
        best[i] = out[i];
        result.label[i] = result.palette[row];
      }
  }
  const bool changed = result.label != brick.smooth.label || result.palette != brick.smooth.palette ||
                       result.share != brick.smooth.share;
  if (changed) brick.smooth = std::move(result);
  return changed;
}

}  // namespace sonoloft
