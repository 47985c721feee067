#include "device_sim/probe/phantoms/smooth_labels.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace sonoloft::device_sim {
namespace {

constexpr std::uint32_t kMixed = 0x10000;  ///< beyond all labels

std::vector<float> gaussian(double sigma, int reach) {
  std::vector<float> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
  for (int i = -reach; i <= reach; ++i)
    weights.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum));
  return weights;
}

/// Copies the voxels [low, low + size) of a volume, outside where it has none.
void gather(const Eigen::Vector3i& dims, std::span<const Label> labels, const std::array<int, 3>& low,
            const std::array<int, 3>& size, std::vector<Label>& block) {
  std::fill(block.begin(), block.end(), kOutside);
  const int x0 = std::max(0, low[0]), x1 = std::min(dims.x(), low[0] + size[0]);
  for (int z = std::max(0, low[2]); z < std::min(dims.z(), low[2] + size[2]) && x0 < x1; ++z) {
    for (int y = std::max(0, low[1]); y < std::min(dims.y(), low[1] + size[1]); ++y) {
      const auto from = labels.begin() + (static_cast<std::ptrdiff_t>(z) * dims.y() + y) * dims.x();
      const auto to = block.begin() + ((z - low[2]) * size[1] + y - low[1]) * size[0] - low[0];
      std::copy(from + x0, from + x1, to + x0);
    }
  }
}

}  // namespace

SmoothLabels::SmoothLabels(const Eigen::Vector3i& dims, const Eigen::Vector3d& sigma_voxel,
                           std::span<const Label> labels) {
  Block block;
  for (std::size_t a = 0; a < 3; ++a) {
    const double sigma = sigma_voxel[static_cast<int>(a)];
    assert(sigma > 0 && sigma <= kMaxSigmaVoxel);
    brick_dims_[a] = (dims[static_cast<int>(a)] + kEdge - 1) / kEdge + 2;
    block.reach[a] = static_cast<int>(std::ceil(3 * sigma - 1e-9));
    block.size[a] = kNodes + 2 * block.reach[a];
    block.weights[a] = gaussian(sigma, block.reach[a]);
  }
  block.labels.resize(static_cast<std::size_t>(block.size[0] * block.size[1] * block.size[2]));
  const std::vector<std::uint32_t> summary = summarise(dims, labels);
  bricks_.resize(summary.size());
  std::size_t i = 0;
  for (int z = 0; z < brick_dims_[2]; ++z) {
    for (int y = 0; y < brick_dims_[1]; ++y) {
      for (int x = 0; x < brick_dims_[0]; ++x, ++i) {
        if (!near_border(x, y, z, summary)) {
          bricks_[i].uniform = static_cast<Label>(summary[i]);
          continue;
        }
        gather(dims, labels,
               {(x - 1) * kEdge - block.reach[0], (y - 1) * kEdge - block.reach[1], (z - 1) * kEdge - block.reach[2]},
               block.size, block.labels);
        blur_brick(bricks_[i], block);
      }
    }
  }
}

/// The label of each brick's own voxels where all agree, else kMixed.
std::vector<std::uint32_t> SmoothLabels::summarise(const Eigen::Vector3i& dims, std::span<const Label> labels) const {
  const auto nx = static_cast<std::size_t>(brick_dims_[0]), ny = static_cast<std::size_t>(brick_dims_[1]);
  constexpr std::uint32_t kNone = kMixed + 1;
  std::vector<std::uint32_t> summary(nx * ny * static_cast<std::size_t>(brick_dims_[2]), kNone);
  std::size_t voxel = 0;
  const auto brick = [](int v) { return static_cast<std::size_t>(v / kEdge + 1); };
  for (int z = 0; z < dims.z(); ++z) {
    for (int y = 0; y < dims.y(); ++y) {
      std::uint32_t* row = &summary[(brick(z) * ny + brick(y)) * nx];
      for (int x = 0; x < dims.x(); ++x, ++voxel) {
        std::uint32_t& s = row[brick(x)];
        s = s == kNone || s == labels[voxel] ? labels[voxel] : kMixed;
      }
    }
  }
  std::replace(summary.begin(), summary.end(), kNone, std::uint32_t{kOutside});
  return summary;
}

bool SmoothLabels::near_border(int x, int y, int z, const std::vector<std::uint32_t>& summary) const {
  const auto at = [&](int bx, int by, int bz) -> std::uint32_t {
    if (bx < 0 || by < 0 || bz < 0 || bx >= brick_dims_[0] || by >= brick_dims_[1] || bz >= brick_dims_[2])
      return kOutside;
    return summary[static_cast<std::size_t>((bz * brick_dims_[1] + by) * brick_dims_[0] + bx)];
  };
  const std::uint32_t own = at(x, y, z);
  if (own == kMixed) return true;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (at(x + dx, y + dy, z + dz) != own) return true;
  return false;
}

void SmoothLabels::blur_brick(Brick& brick, Block& block) {
  brick.first_palette = static_cast<std::uint32_t>(palette_.size());
  brick.first_share = static_cast<std::uint32_t>(shares_.size() / (kNodes * kNodes * kNodes));
  for (const Label label : block.labels)  // few labels, long runs
    if (palette_.size() == brick.first_palette || palette_.back() != label)
      if (std::find(palette_.begin() + brick.first_palette, palette_.end(), label) == palette_.end())
        palette_.push_back(label);
  std::sort(palette_.begin() + brick.first_palette, palette_.end());
  brick.count = static_cast<std::uint16_t>(palette_.size() - brick.first_palette);
  brick.uniform = palette_[brick.first_palette];
  if (brick.count == 1)
    palette_.resize(brick.first_palette);
  else
    for (std::size_t i = brick.first_palette; i < palette_.size(); ++i) add_shares(palette_[i], block);
}

/// Blurs one label along z, y, x, in this order: the inner loops run over x.
void SmoothLabels::add_shares(Label label, Block& block) {
  const auto nx = static_cast<std::size_t>(block.size[0]), ny = static_cast<std::size_t>(block.size[1]);
  constexpr std::size_t kN = kNodes;
  block.z_done.assign(kN * ny * nx, 0);
  for (std::size_t z = 0; z < kN; ++z)
    for (std::size_t k = 0; k < block.weights[2].size(); ++k)
      for (std::size_t i = 0; i < ny * nx; ++i)
        block.z_done[z * ny * nx + i] += block.labels[(z + k) * ny * nx + i] == label ? block.weights[2][k] : 0.0f;
  block.y_done.assign(kN * kN * nx, 0);
  for (std::size_t z = 0; z < kN; ++z)
    for (std::size_t y = 0; y < kN; ++y)
      for (std::size_t k = 0; k < block.weights[1].size(); ++k)
        for (std::size_t x = 0; x < nx; ++x)
          block.y_done[(z * kN + y) * nx + x] += block.weights[1][k] * block.z_done[(z * ny + y + k) * nx + x];
  for (std::size_t row = 0; row < kN * kN; ++row) {
    for (std::size_t x = 0; x < kN; ++x) {
      float sum = 0;
      for (std::size_t k = 0; k < block.weights[0].size(); ++k)
        sum += block.weights[0][k] * block.y_done[row * nx + x + k];
      shares_.push_back(static_cast<std::uint16_t>(std::min(sum, 1.0f) * 65535.0f + 0.5f));
    }
  }
}

Label SmoothLabels::label_at(const Eigen::Vector3d& point_voxel) const {
  std::array<std::size_t, 3> b, node;
  std::array<float, 3> t;
  for (std::size_t a = 0; a < 3; ++a) {
    const double v = point_voxel[static_cast<int>(a)] + kEdge;  // from the first brick's first node
    if (!(v >= 0 && v < brick_dims_[a] * kEdge)) return kOutside;
    const auto floor = static_cast<std::size_t>(v);
    b[a] = floor / kEdge;
    node[a] = floor % kEdge;
    t[a] = static_cast<float>(v - static_cast<double>(floor));
  }
  const auto nx = static_cast<std::size_t>(brick_dims_[0]), ny = static_cast<std::size_t>(brick_dims_[1]);
  const Brick& brick = bricks_[(b[2] * ny + b[1]) * nx + b[0]];
  if (brick.count == 1) return brick.uniform;
  constexpr std::size_t kN = kNodes;
  const std::uint16_t* s = &shares_[brick.first_share * kN * kN * kN + (node[2] * kN + node[1]) * kN + node[0]];
  Label best = kOutside;
  float most = -1;
  for (std::size_t i = 0; i < brick.count; ++i, s += kN * kN * kN) {
    const auto along_x = [&](std::size_t at) {
      return static_cast<float>(s[at]) + t[0] * static_cast<float>(s[at + 1] - s[at]);
    };
    const float y0 = along_x(0) + t[1] * (along_x(kN) - along_x(0));
    const float y1 = along_x(kN * kN) + t[1] * (along_x(kN * kN + kN) - along_x(kN * kN));
    const float share = y0 + t[2] * (y1 - y0);
    if (share <= most) continue;
    most = share;
    best = palette_[brick.first_palette + i];
  }
  return best;
}

}  // namespace sonoloft::device_sim
