#include "tests/support/mesh/synthetic_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

namespace sonoloft::test {
namespace {

BrickCoord brick_of(const Eigen::Vector3i& p) {
  return {p.x() >> 3, p.y() >> 3, p.z() >> 3};
}
std::size_t sample_of(const Eigen::Vector3i& p) {
  return static_cast<std::size_t>(sample_index(p.x() & 7, p.y() & 7, p.z() & 7));
}

template <class Body>
void for_each_point(const Eigen::Vector3i& lower, const Eigen::Vector3i& upper, const Body& body) {
  for (int z = lower.z(); z <= upper.z(); ++z)
    for (int y = lower.y(); y <= upper.y(); ++y)
      for (int x = lower.x(); x <= upper.x(); ++x) body(Eigen::Vector3i(x, y, z));
}

bool same(const Brick& a, const Brick& b) {
  return a.label == b.label && a.palette == b.palette && a.share.size() == b.share.size() &&
         std::memcmp(a.share.data(), b.share.data(), a.share.size() * sizeof(float)) == 0;
}

/// One number in 0..1 for a seed, a label and a point.
float noise(std::uint64_t seed, std::size_t label, const Eigen::Vector3i& p) {
  std::uint64_t h = seed * 0x9E3779B97F4A7C15ull + label;
  for (const int c : {p.x(), p.y(), p.z()}) {  // splitmix64
    h += static_cast<std::uint64_t>(static_cast<std::uint32_t>(c)) + 0x9E3779B97F4A7C15ull;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBull;
    h ^= h >> 31;
  }
  return static_cast<float>(h >> 40) / static_cast<float>(1 << 24);
}

}  // namespace

SyntheticLattice::SyntheticLattice(int size, int labels, const ShareField& field, const Eigen::Vector3d& origin_mm,
                                   double spacing_mm)
    : size_(size), labels_(labels), origin_mm_(origin_mm), spacing_mm_(spacing_mm) {
  const auto points = static_cast<std::size_t>((size + 1) * (size + 1) * (size + 1));
  share_.assign(points * static_cast<std::size_t>(labels), 0.0F);
  label_.assign(points, kOutside);
  for (std::size_t i = 0; i < points; ++i) share_[i * static_cast<std::size_t>(labels)] = 1;
  edit(Eigen::Vector3i::Zero(), Eigen::Vector3i::Constant(size), field);
}

std::size_t SyntheticLattice::index(Eigen::Vector3i p) const {
  return static_cast<std::size_t>(p.x() + (size_ + 1) * (p.y() + (size_ + 1) * p.z()));
}

void SyntheticLattice::fill(Eigen::Vector3i lower, Eigen::Vector3i upper, const ShareField& field) {
  lower = lower.cwiseMax(1);
  upper = upper.cwiseMin(size_ - 1);  // the border stays outside
  const auto labels = static_cast<std::size_t>(labels_);
  for_each_point(lower, upper, [&](const Eigen::Vector3i& p) {
    const std::span<float> shares(share_.data() + index(p) * labels, labels);
    std::fill(shares.begin(), shares.end(), 0.0F);
    field(p, shares);
    label_[index(p)] = static_cast<Label>(std::max_element(shares.begin(), shares.end()) - shares.begin());
  });
}

std::vector<char> SyntheticLattice::near_surface() const {
  std::vector<char> needed(label_.size(), 0);
  for_each_point(Eigen::Vector3i::Zero(), Eigen::Vector3i::Constant(size_ - 1), [&](const Eigen::Vector3i& p) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i step = Eigen::Vector3i::Unit(axis);
      if (label_[index(p)] == label_[index(p + step)]) continue;
      const Eigen::Vector3i margin = Eigen::Vector3i::Ones() - step;
      for_each_point(p - margin, p + step + margin, [&](const Eigen::Vector3i& q) { needed[index(q)] = 1; });
    }
  });
  return needed;
}

SyntheticLattice::Bricks SyntheticLattice::sample() const {
  std::unordered_map<BrickCoord, std::vector<Eigen::Vector3i>, BrickCoordHash> points;
  const std::vector<char> needed = near_surface();
  for_each_point(Eigen::Vector3i::Zero(), Eigen::Vector3i::Constant(size_), [&](const Eigen::Vector3i& p) {
    if (needed[index(p)]) points[brick_of(p)].push_back(p);
  });
  Bricks bricks;
  for (const auto& [coord, own] : points) bricks[coord] = make_brick(coord, own);
  return bricks;
}

Brick SyntheticLattice::make_brick(BrickCoord coord, const std::vector<Eigen::Vector3i>& points) const {
  Brick brick{coord, {}, {}, {}, {}, {}};
  brick.label.fill(kNotSampled);
  for (const auto& p : points) brick.label[sample_of(p)] = label_[index(p)];
  for (std::size_t label = 0; label < static_cast<std::size_t>(labels_); ++label) {
    std::vector<float> shares(kBrickSamples, 0.0F);
    for (const auto& p : points) shares[sample_of(p)] = share_[index(p) * static_cast<std::size_t>(labels_) + label];
    if (std::all_of(shares.begin(), shares.end(), [](float share) { return share == 0; })) continue;
    brick.palette.push_back(static_cast<Label>(label));
    brick.share.insert(brick.share.end(), shares.begin(), shares.end());
  }
  return brick;
}

std::vector<BrickCoord> SyntheticLattice::edit(Eigen::Vector3i lower, Eigen::Vector3i upper, const ShareField& field) {
  fill(lower, upper, field);
  const Bricks before = std::exchange(bricks_, sample());
  std::set<BrickCoord> changed;
  const auto add = [&](const BrickCoord& c) {  // the cells of the bricks below end in its lowest samples
    for (int i = 0; i < 8; ++i) changed.insert({c.x - (i & 1), c.y - (i >> 1 & 1), c.z - (i >> 2)});
  };
  for (const auto& [coord, brick] : bricks_)
    if (const auto old = before.find(coord); old == before.end() || !same(old->second, brick)) add(coord);
  for (const auto& [coord, brick] : before)
    if (!bricks_.contains(coord)) add(coord);
  return {changed.begin(), changed.end()};
}

const Brick* SyntheticLattice::find(BrickCoord coord) const {
  const auto found = bricks_.find(coord);
  return found == bricks_.end() ? nullptr : &found->second;
}

std::vector<BrickCoord> SyntheticLattice::bricks() const {
  std::vector<BrickCoord> result;
  for (const auto& [coord, brick] : bricks_) result.push_back(coord);
  std::sort(result.begin(), result.end());
  return result;
}

ShareField sphere_field(Eigen::Vector3d centre, double radius) {
  return spheres_field({{centre, radius}});
}

ShareField spheres_field(std::vector<std::pair<Eigen::Vector3d, double>> spheres) {
  return [spheres = std::move(spheres)](Eigen::Vector3i point, std::span<float> shares) {
    double deepest = -1e9;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const double depth = spheres[i].second - (point.cast<double>() - spheres[i].first).norm();
      shares[i + 1] = static_cast<float>(std::max(0.0, depth));
      deepest = std::max(deepest, depth);
    }
    shares[0] = static_cast<float>(std::max(0.0, -deepest));
  };
}

ShareField noise_field(std::uint64_t seed, int smoothing) {
  return [seed, smoothing](Eigen::Vector3i point, std::span<float> shares) {
    const Eigen::Vector3i reach = Eigen::Vector3i::Constant(smoothing);
    for (std::size_t label = 0; label < shares.size(); ++label)
      for_each_point(point - reach, point + reach,
                     [&](const Eigen::Vector3i& p) { shares[label] += noise(seed, label, p); });
  };
}

ShareField waves_field(std::uint64_t seed) {
  return [seed](Eigen::Vector3i point, std::span<float> shares) {
    for (std::size_t label = 0; label < shares.size(); ++label) {
      for (int wave = 0; wave < 6; ++wave) {
        const auto number = [&](int which) { return static_cast<double>(noise(seed, label, {wave, which, 0})); };
        const Eigen::Vector3d direction = Eigen::Vector3d(number(0), number(1), number(2)).array() - 0.5;
        const double phase = direction.normalized().dot(point.cast<double>()) / (8 + 12 * number(3)) + number(4);
        shares[label] += static_cast<float>(std::sin(2 * M_PI * phase));
      }
    }
  };
}

}  // namespace sonoloft::test
