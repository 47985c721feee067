#include "core/background/tile_solver.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include "core/slice/four.h"

namespace sonoloft {
namespace {

using Eigen::AlignedBox3i;
using Eigen::Vector3i;

AlignedBox3i grown(const AlignedBox3i& box, int by) {
  return {box.min().array() - by, box.max().array() + by};
}

AlignedBox3i bricks_around(const AlignedBox3i& nodes) {
  return {brick_of(nodes.min()), brick_of(nodes.max())};
}

std::size_t count(const AlignedBox3i& box) {
  return static_cast<std::size_t>((box.sizes().array() + 1).prod());
}

/// Relaxation of each sweep of a level: the roots of the Chebyshev polynomial that is small on [0.1, 2], where the
/// eigenvalues lie of errors too fine for the coarser levels; from both ends in turn, so that rounding does not grow.
const std::array<float, 2 * kSweeps>& relaxations() {
  static const std::array<float, 2 * kSweeps> all = [] {
    std::array<float, 2 * kSweeps> r{};
    for (int k = 0; k < 2 * kSweeps; ++k) {
      const int root = k % 2 == 0 ? k / 2 : 2 * kSweeps - 1 - k / 2;
      const double angle = std::numbers::pi * (2 * root + 1) / (4 * kSweeps);
      r[static_cast<std::size_t>(k)] = static_cast<float>(1 / (1.05 + 0.95 * std::cos(angle)));
    }
    return r;
  }();
  return all;
}

/// A sweep over nodes in a row; their neighbours in y and z lie the strides away.
void relax(const float* now, const float* inverse, const float* source, float* next, std::size_t length,
           std::size_t stride_y, std::size_t stride_z, float relaxation) {
  const float *below = now - stride_y, *above = now + stride_y, *before = now - stride_z, *behind = now + stride_z;
  const float *left = now - 1, *right = now + 1;
  for (std::size_t i = 0; i < length; ++i) {
    const float sum = ((left[i] + right[i]) + (below[i] + above[i])) + (before[i] + behind[i]);
    next[i] = now[i] + relaxation * ((sum + source[i]) * inverse[i] - now[i]);
  }
}

static_assert(kBrickEdge % kFour == 0 && kSweeps % kFour == 0, "rows of the region in a brick are whole fours");

/// Four weights as numbers.
Four load_weights(const std::uint32_t* from) {
  std::uint32_t __attribute__((vector_size(kFour * sizeof(std::uint32_t)))) weights;
  std::memcpy(&weights, from, sizeof weights);
  return __builtin_convertvector(weights, Four);
}

/// Draws shares to what the data say: wholly where they weigh 1 and more, not where they say nothing.
void draw_to(const std::uint32_t* weight, const std::uint32_t* of_label, float* share, std::size_t length) {
  constexpr float kUnit = kWeightUnit;
  for (std::size_t i = 0; i < length; i += kFour) {
    const Four all = load_weights(weight + i), now = load_four(share + i);
    const Four capped = (all < kUnit ? all : kUnit + Four{}) / kUnit;
    store_four(now + capped * (load_weights(of_label + i) / (all > 1 ? all : 1 + Four{}) - now), share + i);
  }
}

/// Values twice as dense along one axis: a fine node lies between two coarse ones, a quarter from the nearer.
/// in [planes][n_coarse][inner], out [planes][n_fine][inner]; fine node 0 lies between coarse nodes 0 and 1, nearer
/// to 1.
void refine(const float* in, float* out, std::size_t planes, std::size_t n_coarse, std::size_t n_fine,
            std::size_t inner) {
  for (std::size_t p = 0; p < planes; ++p)
    for (std::size_t f = 0; f < n_fine; ++f) {
      const float* low = in + (p * n_coarse + (f + 1) / 2) * inner;
      const float share = f % 2 == 0 ? 0.75f : 0.25f;
      float* to = out + (p * n_fine + f) * inner;
      for (std::size_t i = 0; i < inner; ++i) to[i] = low[i] + share * (low[i + inner] - low[i]);
    }
}

}  // namespace

void TileSolver::set_tile(const PassView& pass, const AlignedBox3i& bricks) {
  pass_ = pass;
  region_ = grown({nodes_of(bricks.min()).min(), nodes_of(bricks.max()).max()}, kSweeps);
  coarse_ = region_;
  if (pass.from_coarser)  // and one node more on each side; region_ starts at an even node
    coarse_ = {region_.min().unaryExpr([](int i) { return (i >> 1) - 1; }),
               region_.max().unaryExpr([](int i) { return (i >> 1) + 1; })};
  const Vector3i size = region_.sizes().array() + 1;
  stride_y_ = static_cast<std::size_t>(size.x());
  stride_z_ = stride_y_ * static_cast<std::size_t>(size.y());
  for (std::vector<float>* v : {&inverse_, &source_, &now_, &next_}) v->resize(count(region_));
  find_labels();
  if (!labels_.empty()) fill_diagonal();
}

void TileSolver::find_labels() {
  labels_.clear();
  const auto take = [&](const std::vector<Label>& found) { labels_.insert(labels_.end(), found.begin(), found.end()); };
  for_each_in(bricks_around(region_), [&](const Vector3i& b) {
    if (const NodeData* data = pass_.data->find(b)) take(data->of_label.labels);
  });
  if (pass_.before != nullptr)
    for_each_in(bricks_around(coarse_), [&](const Vector3i& b) {
      if (const NodeShares* shares = pass_.before->find(b)) take(shares->of_label.labels);
    });
  std::sort(labels_.begin(), labels_.end());
  labels_.erase(std::unique(labels_.begin(), labels_.end()), labels_.end());
}

void TileSolver::fill_diagonal() {
  std::fill(inverse_.begin(), inverse_.end(), 0.0f);
  const AlignedBox3i inside = region_.intersection(pass_.data->nodes());
  for_each_row(inside, [&](const Vector3i& node, std::size_t length) {
    std::fill_n(inverse_.begin() + static_cast<std::ptrdiff_t>(at(node)), length, 1 / (6 + pass_.screening));
  });
  for_each_in(bricks_around(region_), [&](const Vector3i& b) {
    const NodeData* data = pass_.data->find(b);
    if (data == nullptr) return;
    for_each_row(nodes_of(b).intersection(inside), [&](const Vector3i& node, std::size_t length) {
      const std::uint32_t* weight = data->weight.data() + node_index(node.x(), node.y(), node.z());
      float* out = inverse_.data() + at(node);
      for (std::size_t i = 0; i < length; ++i)
        out[i] = 1 / (6 + pass_.screening + kDataStiffness / kWeightUnit * static_cast<float>(weight[i]));
    });
  });
}

void TileSolver::gather(Label label, std::vector<float>& out) const {
  out.assign(count(coarse_), 0.0f);
  const Vector3i size = coarse_.sizes().array() + 1;
  for_each_in(bricks_around(coarse_), [&](const Vector3i& b) {
    const NodeShares* shares = pass_.before->find(b);
    const auto* row = shares == nullptr ? nullptr : shares->of_label.find(label);
    if (row == nullptr) return;
    for_each_row(nodes_of(b).intersection(coarse_), [&](const Vector3i& node, std::size_t length) {
      const Vector3i p = node - coarse_.min();
      const std::uint16_t* from = row->data() + node_index(node.x(), node.y(), node.z());
      float* to = out.data() + (p.x() + size.x() * (p.y() + size.y() * p.z()));
      for (std::size_t i = 0; i < length; ++i) to[i] = static_cast<float>(from[i]) / kShareUnit;
    });
  });
}

/// The start of a level: the coarser level's shares, trilinear; 0 beyond the lattice.
void TileSolver::push(Label label) {
  gather(label, coarse_shares_);
  const auto coarse = (coarse_.sizes().array() + 1).cast<std::size_t>().eval();
  const auto fine = (region_.sizes().array() + 1).cast<std::size_t>().eval();
  along_x_.resize(fine.x() * coarse.y() * coarse.z());
  along_y_.resize(fine.x() * fine.y() * coarse.z());
  refine(coarse_shares_.data(), along_x_.data(), coarse.y() * coarse.z(), coarse.x(), fine.x(), 1);
  refine(along_x_.data(), along_y_.data(), coarse.z(), coarse.y(), fine.y(), fine.x());
  refine(along_y_.data(), now_.data(), 1, coarse.z(), fine.z(), fine.x() * fine.y());
  if (pass_.data->nodes().contains(region_)) return;
  for_each_in(region_, [&](const Vector3i& node) {
    if (!pass_.data->nodes().contains(node)) now_[at(node)] = 0;
  });
}

/// The data of the label; the start of a level is drawn to them.
void TileSolver::apply_data(Label label) {
  static constexpr LabelRows<std::uint32_t>::Row kNone{};
  std::fill(source_.begin(), source_.end(), 0.0f);
  for_each_in(bricks_around(region_), [&](const Vector3i& b) {
    const NodeData* data = pass_.data->find(b);
    if (data == nullptr) return;
    const auto* found = data->of_label.find(label);
    const auto& row = found == nullptr ? kNone : *found;
    for_each_row(nodes_of(b).intersection(region_), [&](const Vector3i& node, std::size_t length) {
      const std::size_t first = node_index(node.x(), node.y(), node.z()), out = at(node);
      for (std::size_t i = 0; i < length; i += kFour)
        store_four(kDataStiffness / kWeightUnit * load_weights(&row[first + i]), &source_[out + i]);
      if (first_of_level()) draw_to(&data->weight[first], &row[first], &now_[out], length);
    });
  });
}

void TileSolver::solve(Label label) {
  if (pass_.from_coarser) {
    push(label);
  } else if (pass_.before != nullptr) {
    gather(label, now_);
  } else {
    std::fill(now_.begin(), now_.end(), 0.0f);
  }
  apply_data(label);
  for (int k = 0; k < kSweeps; ++k) {
    const float relaxation = relaxations()[static_cast<std::size_t>(first_of_level() ? k : kSweeps + k)];
    // Each sweep is right one node less far out than the one before. Rows run on into the next: what that makes of the
    // ends is not used.
    const AlignedBox3i right = grown(region_, -k - 1);
    for (int z = right.min().z(); z <= right.max().z(); ++z) {
      const std::size_t first = at({right.min().x(), right.min().y(), z});
      const std::size_t length = at({right.max().x(), right.max().y(), z}) + 1 - first;
      relax(&now_[first], &inverse_[first], &source_[first], &next_[first], length, stride_y_, stride_z_, relaxation);
    }
    std::swap(now_, next_);
  }
}

}  // namespace sonoloft
