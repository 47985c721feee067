#include "core/background/cascade.h"

#include <atomic>
#include <iterator>
#include <utility>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

using Eigen::AlignedBox3i;
using Eigen::Vector3i;

constexpr std::size_t kLevels = 4;             ///< nodes of the coarsest are one screening length apart
constexpr float kFinestScreening = 1.0f / 64;  ///< (spacing / screening length)^2
constexpr int kTileBricks = 2;                 ///< along an edge: more share their surroundings, fewer stay in a cache

Vector3i halved(const Vector3i& v) {
  return {v.x() >> 1, v.y() >> 1, v.z() >> 1};
}

/// What the eight finer nodes of one node say together, none with more weight than one slice has. A quarter of the sum
/// would be their area; with three sixteenths the coarse solution comes nearest to the fine one.
class Pull {
 public:
  Pull(const NodeData* fine, const Vector3i& node) : fine_(fine) {
    for (int corner = 0; corner < 8; ++corner)
      at_[static_cast<std::size_t>(corner)] =
          node_index(2 * node.x() + (corner & 1), 2 * node.y() + ((corner >> 1) & 1), 2 * node.z() + (corner >> 2));
  }
  [[nodiscard]] std::uint32_t weight() const {
    std::uint64_t sum = 0;
    if (fine_ != nullptr)
      for (const std::size_t i : at_) sum += std::min(fine_->weight[i], kWeightUnit);
    return rounded(sum);
  }
  [[nodiscard]] std::uint32_t of(Label label) const {
    const auto* row = fine_ == nullptr ? nullptr : fine_->of_label.find(label);
    if (row == nullptr) return 0;
    std::uint64_t sum = 0;
    for (const std::size_t i : at_) {
      const std::uint64_t weight = fine_->weight[i], own = (*row)[i];
      sum += weight <= kWeightUnit ? own : own * kWeightUnit / weight;
    }
    return rounded(sum);
  }

 private:
  static std::uint32_t rounded(std::uint64_t sum) { return static_cast<std::uint32_t>((3 * sum + 8) / 16); }

  const NodeData* fine_;
  std::array<std::size_t, 8> at_{};
};

/// Between passes. Finer makes the result no better (measured), but small changes run farther.
struct RoundBetween {
  static constexpr float kStep = 8;
  std::uint16_t operator()(float share) const {
    const float steps = std::clamp(share, 0.0f, 1.0f) * (kShareUnit / kStep) + 0.5f;
    return static_cast<std::uint16_t>(static_cast<int>(steps) * static_cast<int>(kStep));
  }
};

/// In the end. Surfaces lie where shares are large: small ones need not be exact, and would change most often.
struct RoundResult {
  std::uint16_t operator()(float share) const {
    const float units = std::clamp(share, 0.0f, 1.0f) * kShareUnit;
    const int fine = static_cast<int>(units + 0.5f), coarse = static_cast<int>(units * 0.25f + 0.5f) * 4;
    return static_cast<std::uint16_t>(units < kShareUnit / 4.0f ? coarse : fine);
  }
};

/// Finds the largest share of every node and takes from it what rounding gave all together too much.
void finish(NodeShares& shares) {
  std::array<std::int16_t, kBrickNodes> outside, largest{};
  outside.fill(kShareUnit);
  shares.top.fill(kOutside);
  const auto look_at = [&](std::size_t r, std::size_t i) {
    const auto share = static_cast<std::int16_t>(shares.of_label.rows[r][i]);
    const bool larger = share > largest[i];
    shares.top[i] = larger ? shares.of_label.labels[r] : shares.top[i];
    largest[i] = larger ? share : largest[i];
    return share;
  };
  const std::size_t count = shares.of_label.rows.size();
  for (std::size_t r = 0; r < count; ++r)
    for (std::size_t i = 0; i < kBrickNodes; ++i) outside[i] = static_cast<std::int16_t>(outside[i] - look_at(r, i));
  for (std::size_t i = 0; i < kBrickNodes; ++i) {
    if (outside[i] < 0) {
      std::uint16_t& share = shares.of_label.find_or_add(shares.top[i])[i];
      share = static_cast<std::uint16_t>(share + std::exchange(outside[i], std::int16_t{0}));
      largest[i] = 0;
      for (std::size_t r = 0; r < count; ++r) look_at(r, i);
    }
    if (largest[i] <= outside[i]) shares.top[i] = kOutside;
  }
}

std::bitset<kBrickNodes> difference(const NodeShares* before, const NodeShares* now) {
  static const NodeShares kNone;
  static constexpr LabelRows<std::uint16_t>::Row kZero{};
  const auto &a = (before != nullptr ? *before : kNone).of_label, &b = (now != nullptr ? *now : kNone).of_label;
  std::vector<Label> labels;
  std::set_union(a.labels.begin(), a.labels.end(), b.labels.begin(), b.labels.end(), std::back_inserter(labels));
  std::bitset<kBrickNodes> differ;
  for (const Label label : labels) {
    const auto *p = a.find(label), *q = b.find(label);
    const auto &x = p != nullptr ? *p : kZero, &y = q != nullptr ? *q : kZero;
    if (x == y) continue;
    for (std::size_t i = 0; i < kBrickNodes; ++i)
      if (x[i] != y[i]) differ.set(i);
  }
  return differ;
}

bool assign(std::uint32_t& own, std::uint32_t value) {
  const bool differs = own != value;
  own = value;
  return differs;
}

}  // namespace

Cascade::Cascade(const Vector3i& nodes) {
  Vector3i size = nodes;
  for (std::size_t l = 0; l < kLevels; ++l) {
    levels_.emplace_back(size);
    size = halved(size.array() + 1);
  }
  for (std::size_t p = 0; p < 2 * kLevels; ++p)
    passes_.emplace_back(levels_[level_of(p)].data.nodes().max().array() + 1);
}

/// Removes what has become nothing.
void Cascade::tidy(Level& level) {
  for (const std::size_t b : level.touched.bricks()) {
    std::unique_ptr<NodeData>& data = level.data[b];
    data->of_label.remove_zero_rows();
    if (data->empty()) data.reset();
  }
}

void Cascade::pull(const Level& fine, Level& coarse) {
  for (const std::size_t b : fine.touched.bricks()) {
    const NodeData* child = fine.data[b].get();
    const std::size_t parent_brick = coarse.data.index(halved(fine.data.brick(b)));
    NodeData& parent = coarse.data.find_or_add(parent_brick);
    if (child != nullptr)
      for (const Label label : child->of_label.labels) parent.of_label.find_or_add(label);
    const std::vector<Label>& labels = parent.of_label.labels;
    const AlignedBox3i& box = fine.touched.box(b);
    for_each_in({halved(box.min()), halved(box.max())}, [&](const Vector3i& node) {
      const Pull pulled(child, node);
      const std::size_t at = node_index(node.x(), node.y(), node.z());
      bool changed = assign(parent.weight[at], pulled.weight());
      for (std::size_t r = 0; r < labels.size(); ++r)
        changed |= assign(parent.of_label.rows[r][at], pulled.of(labels[r]));
      if (changed) coarse.touched.extend(parent_brick, AlignedBox3i(node, node));
    });
  }
}

PassView Cascade::view(std::size_t p) const {
  const std::size_t level = level_of(p);
  return {&levels_[level].data, p == 0 ? nullptr : &passes_[p - 1].shares, p > 0 && level_of(p - 1) != level,
          kFinestScreening * static_cast<float>(1u << (2 * level))};
}

/// Boxes of bricks, one a tile, that hold every node within reach of changed data or of changed shares started from.
std::vector<AlignedBox3i> Cascade::stale_tiles(std::size_t p) const {
  const Level& level = levels_[level_of(p)];
  const AlignedBox3i& bricks = level.data.bricks();
  const Vector3i tiles = bricks.max().array() / kTileBricks + 1;
  ChangedNodes stale(static_cast<std::size_t>(tiles.prod()));  // of "nodes" that are bricks
  const auto reach = [&](const AlignedBox3i& nodes) {
    const AlignedBox3i near =
        AlignedBox3i(brick_of(nodes.min().array() - kSweeps), brick_of(nodes.max().array() + kSweeps))
            .intersection(bricks);
    for_each_in({near.min() / kTileBricks, near.max() / kTileBricks}, [&](const Vector3i& t) {
      const AlignedBox3i tile(kTileBricks * t, (kTileBricks * t).array() + (kTileBricks - 1));
      const int index = t.x() + tiles.x() * (t.y() + tiles.y() * t.z());
      stale.extend(static_cast<std::size_t>(index), near.intersection(tile));
    });
  };
  for (const std::size_t b : level.touched.bricks()) reach(level.touched.box(b));
  if (p > 0)
    for (const RenewedNodes& renewed : passes_[p - 1].renewed)
      for_each_in(nodes_of(passes_[p - 1].shares.brick(renewed.brick)), [&](const Vector3i& node) {
        if (!renewed.nodes.test(node_index(node.x(), node.y(), node.z()))) return;
        if (view(p).from_coarser) {
          reach({2 * node.array() - 1, 2 * node.array() + 2});
        } else {
          reach({node, node});
        }
      });
  std::vector<AlignedBox3i> boxes;
  for (const std::size_t t : stale.bricks()) boxes.push_back(stale.box(t));
  return boxes;
}

void Cascade::solve_tile(std::size_t p, const AlignedBox3i& bricks, TileSolver& solver,
                         std::vector<RenewedNodes>& renewed) {
  Pass& pass = passes_[p];
  const bool last_pass = p + 1 == passes_.size();
  solver.set_tile(view(p), bricks);
  std::vector<std::unique_ptr<NodeShares>> fresh(static_cast<std::size_t>((bricks.sizes().array() + 1).prod()));
  for (const Label label : solver.labels()) {
    solver.solve(label);
    LabelRows<std::uint16_t>::Row row;
    std::size_t at = 0;
    for_each_in(bricks, [&](const Vector3i& b) {
      std::unique_ptr<NodeShares>& shares = fresh[at++];
      const bool any = last_pass ? solver.store(b, row, RoundResult{}) : solver.store(b, row, RoundBetween{});
      if (!any) return;
      if (!shares) shares = std::make_unique<NodeShares>();
      shares->of_label.find_or_add(label) = row;
    });
  }
  std::size_t at = 0;
  for_each_in(bricks, [&](const Vector3i& b) {
    std::unique_ptr<NodeShares>& shares = fresh[at++];
    std::unique_ptr<NodeShares>& held = pass.shares[pass.shares.index(b)];
    if (shares && last_pass) finish(*shares);
    const auto nodes = difference(held.get(), shares.get());
    if (nodes.none()) return;
    held = std::move(shares);
    renewed.push_back({pass.shares.index(b), nodes});
  });
}

void Cascade::run(std::size_t p, int threads) {
  const std::vector<AlignedBox3i> tiles = stale_tiles(p);
  std::vector<std::vector<RenewedNodes>> renewed(tiles.size());
  std::atomic<std::size_t> next{0};
  parallel_for(static_cast<std::size_t>(threads), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t thread = first; thread < last; ++thread)
      for (std::size_t t = next++; t < tiles.size(); t = next++) solve_tile(p, tiles[t], solvers_[thread], renewed[t]);
  });
  std::vector<RenewedNodes>& all = passes_[p].renewed;
  all.clear();
  for (const auto& part : renewed) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end(), [](const RenewedNodes& a, const RenewedNodes& b) { return a.brick < b.brick; });
}

const std::vector<RenewedNodes>& Cascade::solve(int threads) {
  solvers_.resize(std::max(solvers_.size(), static_cast<std::size_t>(threads)));
  for (std::size_t l = 0; l < kLevels; ++l) {
    tidy(levels_[l]);
    if (l + 1 < kLevels) pull(levels_[l], levels_[l + 1]);
  }
  for (std::size_t p = 0; p < passes_.size(); ++p) run(p, threads);
  for (Level& level : levels_) level.touched.clear();
  return passes_.back().renewed;
}

std::size_t Cascade::memory_bytes() const {
  std::size_t bytes = 0;
  for (const Level& level : levels_)
    for (std::size_t b = 0; b < level.data.capacity(); ++b)
      if (const auto& data = level.data[b])
        bytes += sizeof *data + data->of_label.rows.capacity() * sizeof(LabelRows<std::uint32_t>::Row);
  for (const Pass& pass : passes_)
    for (std::size_t b = 0; b < pass.shares.capacity(); ++b)
      if (const auto& shares = pass.shares[b])
        bytes += sizeof *shares + shares->of_label.rows.capacity() * sizeof(LabelRows<std::uint16_t>::Row);
  return bytes;
}

}  // namespace sonoloft
