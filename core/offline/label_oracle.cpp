#include "core/offline/label_oracle.h"

#include <algorithm>
#include <set>

namespace sonoloft {
namespace {

/// The bricks that the corners of a brick's cells lie in.
class CornerBricks {
 public:
  CornerBricks(const SampleLattice& samples, const BrickCoord& c) {
    for (int i = 0; i < 8; ++i)
      bricks_[static_cast<std::size_t>(i)] = samples.find({c.x + (i & 1), c.y + (i >> 1 & 1), c.z + (i >> 2)});
  }
  /// @param p  relative to the brick's first sample, 0..8
  [[nodiscard]] const Brick* brick(const Eigen::Vector3i& p) const {
    return bricks_[static_cast<std::size_t>(p.x() / kBrickSize + 2 * (p.y() / kBrickSize) + 4 * (p.z() / kBrickSize))];
  }
  [[nodiscard]] static std::size_t index(const Eigen::Vector3i& p) {
    return static_cast<std::size_t>(sample_index(p.x() % kBrickSize, p.y() % kBrickSize, p.z() % kBrickSize));
  }
  [[nodiscard]] Label label(const Eigen::Vector3i& p) const {
    const Brick* b = brick(p);
    return b == nullptr ? kNotSampled : b->label[index(p)];
  }

 private:
  std::array<const Brick*, 8> bricks_;
};

Eigen::Vector3i corner(const Eigen::Vector3i& cell, int i) {
  return cell + Eigen::Vector3i(i & 1, i >> 1 & 1, i >> 2);
}

bool mixed(const std::array<Label, 8>& labels) {
  return std::ranges::count(labels, kNotSampled) == 0 && std::ranges::count(labels, labels[0]) < 8;
}

/// Cells with a vertex of a chunk lie in its brick or beside it.
std::set<BrickCoord> bricks_around(const MeshSnapshot& live) {
  std::set<BrickCoord> bricks;
  for (const auto& chunk : live.chunks)
    for (int i = 0; i < 27; ++i)
      bricks.insert({chunk->coord.x + i % 3 - 1, chunk->coord.y + i / 3 % 3 - 1, chunk->coord.z + i / 9 - 1});
  return bricks;
}

}  // namespace

LabelOracle::LabelOracle(const SampleLattice& samples, const MeshSnapshot& live) {
  for (const BrickCoord& coord : bricks_around(live)) add_cells(samples, coord);
  sort_into_rows();
}

void LabelOracle::add_cells(const SampleLattice& samples, const BrickCoord& coord) {
  const CornerBricks corners(samples, coord);
  const Eigen::Vector3i origin = kBrickSize * Eigen::Vector3i(coord.x, coord.y, coord.z);
  for (int i = 0; i < kBrickSamples; ++i) {
    const Eigen::Vector3i cell(i % kBrickSize, i / kBrickSize % kBrickSize, i / (kBrickSize * kBrickSize));
    std::array<Label, 8> labels;
    for (int c = 0; c < 8; ++c) labels[static_cast<std::size_t>(c)] = corners.label(corner(cell, c));
    if (!mixed(labels)) continue;
    const auto first = static_cast<std::uint32_t>(labels_.size());
    for (std::size_t c = 0; c < 8; ++c) {
      const Eigen::Vector3i p = corner(cell, static_cast<int>(c));
      const Brick& brick = *corners.brick(p);
      for (std::size_t s = 0; s < brick.palette.size(); ++s) {
        const float share = brick.share[s * kBrickSamples + CornerBricks::index(p)];
        if (share == 0) continue;
        const auto at = std::lower_bound(labels_.begin() + first, labels_.end(), brick.palette[s]) - labels_.begin();
        if (at == std::ssize(labels_) || labels_[static_cast<std::size_t>(at)] != brick.palette[s]) {
          labels_.insert(labels_.begin() + at, brick.palette[s]);
          shares_.insert(shares_.begin() + at, std::array<float, 8>{});
        }
        shares_[static_cast<std::size_t>(at)][c] = share;
      }
    }
    cells_.push_back({origin + cell, labels[1], static_cast<std::uint16_t>(labels_.size() - first), first});
  }
}

void LabelOracle::sort_into_rows() {
  if (cells_.empty()) return;
  lowest_ = highest_ = cells_[0].at;
  for (const MixedCell& c : cells_) {
    lowest_ = lowest_.cwiseMin(c.at);
    highest_ = highest_.cwiseMax(c.at + Eigen::Vector3i::Ones());
  }
  std::ranges::sort(cells_, [this](const MixedCell& a, const MixedCell& b) {
    return std::pair(row(a.at.y(), a.at.z()), a.at.x()) < std::pair(row(b.at.y(), b.at.z()), b.at.x());
  });
  row_begin_.assign(row(highest_.y() - 1, highest_.z() - 1) + 2, 0);
  for (const MixedCell& c : cells_) ++row_begin_[row(c.at.y(), c.at.z()) + 1];
  for (std::size_t r = 1; r < row_begin_.size(); ++r) row_begin_[r] += row_begin_[r - 1];
}

Label LabelOracle::label(const Eigen::Vector3d& point) const {
  if (!((point.array() >= lowest_.cast<double>().array()).all() &&
        (point.array() < highest_.cast<double>().array()).all()))
    return kOutside;
  const Eigen::Vector3i at = point.array().floor().cast<int>();
  const std::size_t r = row(at.y(), at.z());
  const auto begin = cells_.begin() + row_begin_[r], end = cells_.begin() + row_begin_[r + 1];
  const auto next = std::upper_bound(begin, end, at.x(), [](int x, const MixedCell& c) { return x < c.at.x(); });
  if (next == begin) return kOutside;
  const MixedCell& cell = *(next - 1);
  return cell.at.x() == at.x() ? label_in(cell, point - at.cast<double>()) : cell.beyond;
}

Label LabelOracle::label_in(const MixedCell& cell, const Eigen::Vector3d& offset) const {
  std::array<double, 8> weight;
  for (int c = 0; c < 8; ++c)
    weight[static_cast<std::size_t>(c)] = ((c & 1) != 0 ? offset.x() : 1 - offset.x()) *
                                          ((c & 2) != 0 ? offset.y() : 1 - offset.y()) *
                                          ((c & 4) != 0 ? offset.z() : 1 - offset.z());
  double largest = -1;
  Label winner = kOutside;
  for (std::size_t s = cell.first; s < cell.first + cell.label_count; ++s) {
    double share = 0;
    for (std::size_t c = 0; c < 8; ++c) share += weight[c] * static_cast<double>(shares_[s][c]);
    if (share <= largest) continue;
    largest = share;
    winner = labels_[s];
  }
  return winner;
}

}  // namespace sonoloft
