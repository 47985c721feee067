#include "core/octree/smoothing.h"

#include <algorithm>
#include <array>
#include <set>

namespace sonoloft {
namespace {

constexpr int kReach = 2;
constexpr int kSide = kBrickSize + 2 * kReach;
constexpr int kBlock = kSide * kSide * kSide;
constexpr int kStep[3] = {1, kSide, kSide* kSide};
constexpr float kStrength = 0.25f;

constexpr int block_index(int x, int y, int z) {
  return (x + kReach) + kSide * ((y + kReach) + kSide * (z + kReach));
}

/// The brick and the two layers of samples around it.
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

  void gather_sampled(std::array<bool, kBlock>& out) const {
    visit([&](int at, const WorkBrick* brick, int index) {
      out[static_cast<std::size_t>(at)] = brick != nullptr && brick->sampled.test(index);
    });
  }

  void gather_share(Label label, std::array<float, kBlock>& out) const {
    std::array<const float*, 27> rows;
    for (std::size_t i = 0; i < 27; ++i) rows[i] = around_[i] == nullptr ? nullptr : around_[i]->shares.find(label);
    for (int z = -kReach; z < kBrickSize + kReach; ++z)
      for (int y = -kReach; y < kBrickSize + kReach; ++y)
        for (int x = -kReach; x < kBrickSize + kReach; ++x) {
          const float* row = rows[static_cast<std::size_t>(slot(x, y, z))];
          out[static_cast<std::size_t>(block_index(x, y, z))] =
              row == nullptr ? 0.0f : row[sample_index(x & 7, y & 7, z & 7)];
        }
  }

 private:
  static int slot(int x, int y, int z) { return (x >> 3) + 1 + 3 * ((y >> 3) + 1) + 9 * ((z >> 3) + 1); }

  template <class Visit>
  void visit(Visit visit_sample) const {
    for (int z = -kReach; z < kBrickSize + kReach; ++z)
      for (int y = -kReach; y < kBrickSize + kReach; ++y)
        for (int x = -kReach; x < kBrickSize + kReach; ++x)
          visit_sample(block_index(x, y, z), around_[static_cast<std::size_t>(slot(x, y, z))],
                       sample_index(x & 7, y & 7, z & 7));
  }

  std::array<const WorkBrick*, 27> around_;
};

float laplacian(const std::array<float, kBlock>& f, int at) {
  float sum = 0.0f;
  for (const int step : kStep) sum += f[static_cast<std::size_t>(at - step)] + f[static_cast<std::size_t>(at + step)];
  return sum / 6.0f - f[static_cast<std::size_t>(at)];
}

/// The samples, one step outside of the brick at most, whose eight finest cells are sampled. Only these may change: an
/// edge that a change makes mixed then has its four cells.
void find_inner(const std::array<bool, kBlock>& sampled, std::array<bool, kBlock>& inner) {
  inner = sampled;
  for (const int step : kStep) {
    const std::array<bool, kBlock> before = inner;
    for (int at = step; at < kBlock - step; ++at)
      inner[static_cast<std::size_t>(at)] = before[static_cast<std::size_t>(at)] &&
                                            before[static_cast<std::size_t>(at - step)] &&
                                            before[static_cast<std::size_t>(at + step)];
  }
}

}  // namespace

bool smooth_brick(const BrickPool& bricks, WorkBrick& brick) {
  const Neighbourhood around(bricks, brick);
  std::array<bool, kBlock> sampled;
  std::array<bool, kBlock> inner;
  around.gather_sampled(sampled);
  find_inner(sampled, inner);

  Brick result;
  result.coord = brick.coord;
  result.palette = around.labels();
  result.share.resize(result.palette.size() * kBrickSamples);
  result.label.fill(kNotSampled);
  std::array<float, kBrickSamples> best;
  best.fill(-2.0f);
  std::array<float, kBlock> f;
  std::array<float, kBlock> lf;
  for (std::size_t row = 0; row < result.palette.size(); ++row) {
    around.gather_share(result.palette[row], f);
    for (int at = kStep[2]; at < kBlock - kStep[2]; ++at)  // of the outermost layer nothing is used
      lf[static_cast<std::size_t>(at)] = inner[static_cast<std::size_t>(at)] ? laplacian(f, at) : 0.0f;
    float* out = result.share.data() + row * kBrickSamples;
    for (int i = 0; i < kBrickSamples; ++i) {
      if (!brick.sampled.test(i)) continue;
      const int at = block_index(i & 7, (i >> 3) & 7, i >> 6);
      const bool free = inner[static_cast<std::size_t>(at)] && !brick.pinned.test(i);
      out[i] = f[static_cast<std::size_t>(at)] - (free ? kStrength * laplacian(lf, at) : 0.0f);
      if (out[i] > best[static_cast<std::size_t>(i)]) {
        best[static_cast<std::size_t>(i)] = out[i];
        result.label[static_cast<std::size_t>(i)] = result.palette[row];
      }
    }
  }
  const bool changed = result.label != brick.smooth.label || result.palette != brick.smooth.palette ||
                       result.share != brick.smooth.share;
  if (changed) brick.smooth = std::move(result);
  return changed;
}

}  // namespace sonoloft
