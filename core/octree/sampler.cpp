#include "core/octree/sampler.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/slice/parallel.h"

namespace sonoloft {
namespace {

constexpr std::uint32_t kNoBlock = 0xFFFFFFFF;
constexpr std::uint32_t kBoxWalls = 6;

}  // namespace

Sampler::Sampler(const CellComplex& cells, FieldEvaluator& evaluator, const Background* background,
                 const Eigen::Vector3d& origin_mm, double spacing_mm, int threads)
    : cells_(cells),
      evaluator_(evaluator),
      background_(background),
      origin_mm_(origin_mm),
      spacing_mm_(spacing_mm),
      threads_(threads),
      packed_of_cell_(cells.cell_bound(), kNoCell) {}

Result<std::vector<std::vector<std::uint32_t>>> Sampler::take(BrickPool& bricks, const std::vector<SampleJob>& jobs) {
  located_.resize(jobs.size());
  parallel_for(jobs.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    for (std::size_t j = first; j < last; ++j) locate(bricks[jobs[j].brick], jobs[j].samples, located_[j]);
  });

  const auto start = std::chrono::steady_clock::now();
  std::vector<std::vector<std::uint32_t>> found(jobs.size());
  std::vector<std::size_t> first_group(1, 0);
  groups_.clear();
  for (std::uint32_t j = 0; j < jobs.size(); ++j) {
    for (const CellPoints& points : located_[j].cells) {
      const auto cell = static_cast<std::uint32_t>(points.cell);
      found[j].push_back(cell);
      if (packed_of_cell_[cell] == kNoCell) pack(cell);
      groups_.push_back({j, packed_of_cell_[cell], points.first, points.count, kNoBlock, 0});
    }
    first_group.push_back(groups_.size());
    evaluated_ += located_[j].index.size();
  }
  if (auto done = evaluate(); !done) return tl::unexpected<Error>(done.error());
  field_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  parallel_for(jobs.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    PointShares scratch;
    for (std::size_t j = first; j < last; ++j)
      for (std::size_t g = first_group[j]; g < first_group[j + 1]; ++g)
        store(bricks[jobs[j].brick], groups_[g], located_[j], scratch);
  });
  return found;
}

void Sampler::locate(const WorkBrick& brick, const SampleMask& samples, Located& out) const {
  const Eigen::Vector3d base = Eigen::Vector3i(brick.coord.x, brick.coord.y, brick.coord.z).cast<double>() * kBrickSize;
  std::vector<std::uint16_t> index;
  std::vector<Eigen::Vector3d> points;
  index.reserve(kBrickSamples);
  points.reserve(kBrickSamples);
  samples.for_each([&](int i) {
    index.push_back(static_cast<std::uint16_t>(i));
    points.push_back(origin_mm_ + spacing_mm_ * (base + Eigen::Vector3d(i & 7, (i >> 3) & 7, i >> 6)));
  });
  const Eigen::AlignedBox3d bounds(origin_mm_ + spacing_mm_ * base,
                                   origin_mm_ + spacing_mm_ * (base + Eigen::Vector3d::Constant(kBrickSize - 1)));
  std::vector<std::uint32_t> order;
  cells_.locate(bounds, points, order, out.cells);
  out.index.resize(order.size());
  out.point_mm.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    out.index[i] = index[order[i]];
    out.point_mm[i] = points[order[i]];
  }
}

void Sampler::pack(std::uint32_t cell) {
  cells_.faces(CellId{cell}, faces_);
  packed_of_cell_[cell] = batch_.cells.add(faces_, cells_.centre(CellId{cell}));
  cell_of_packed_.push_back(cell);
  const auto first = static_cast<std::uint32_t>(pins_.size());
  for (const CellFace& face : faces_) {
    if (static_cast<std::uint32_t>(face.plane) < kBoxWalls || face.label == kUnknown) continue;
    const Eigen::Vector3d normal = face.image_to_reference->linear().col(2);
    pins_.push_back({normal, -normal.dot(face.image_to_reference->translation())});
  }
  pins_of_packed_.push_back({first, static_cast<std::uint32_t>(pins_.size()) - first});
}

/// One block a cell, so that a cell's edges are read once for the points of all bricks.
Result<void> Sampler::evaluate() {
  std::vector<std::uint32_t> count(batch_.cells.size(), 0), block(batch_.cells.size(), kNoBlock);  // by packed cell
  for (Group& group : groups_) {
    group.lane = count[group.packed];
    count[group.packed] += group.count;
  }
  batch_.clear_points();
  for (std::uint32_t packed = 0; packed < count.size(); ++packed) {
    if (count[packed] == 0 || batch_.cells.constant(packed)) continue;
    block[packed] = batch_.add_block(packed, count[packed]);
    edge_evaluations_ += std::size_t{count[packed]} * batch_.cells.edge_count(packed);
  }
  if (batch_.blocks.empty()) return {};
  parallel_for(groups_.size(), 64, threads_, [&](std::size_t first, std::size_t last) {
    for (std::size_t g = first; g < last; ++g) {
      Group& group = groups_[g];
      group.block = block[group.packed];
      if (group.block != kNoBlock)
        batch_.set_points(group.block, group.lane, {&located_[group.job].point_mm[group.first], group.count});
    }
  });
  return evaluator_.evaluate(batch_);
}

/// Marks the samples within one spacing of a slice that bounds their cell.
void Sampler::pin(WorkBrick& brick, const Group& group, std::span<const std::uint16_t> index,
                  std::span<const Eigen::Vector3d> points) const {
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3d& p : points) bounds.extend(p);
  for (const std::uint16_t i : index) brick.pinned.reset(i);
  const PinRange range = pins_of_packed_[group.packed];
  for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
    const PinPlane& plane = pins_[i];
    const double reach = 0.5 * plane.normal.cwiseAbs().dot(bounds.sizes());
    if (std::abs(plane.normal.dot(bounds.center()) + plane.offset_mm) > reach + 1.001 * spacing_mm_) continue;
    for (std::size_t k = 0; k < index.size(); ++k)
      if (std::abs(plane.normal.dot(points[k]) + plane.offset_mm) < spacing_mm_) brick.pinned.set(index[k]);
  }
}

void Sampler::store(WorkBrick& brick, const Group& group, const Located& located, PointShares& scratch) const {
  const std::span<const std::uint16_t> index(located.index.data() + group.first, group.count);
  const std::span<const Eigen::Vector3d> points(located.point_mm.data() + group.first, group.count);
  const std::span<const Label> labels = batch_.cells.labels(group.packed);
  const std::uint32_t cell = cell_of_packed_[group.packed];
  for (std::size_t row = 0; row < brick.shares.palette.size(); ++row)
    for (const std::uint16_t i : index) brick.shares.share[row * kBrickSamples + i] = 0.0f;
  const bool partly_unknown = labels.back() == kUnknown;
  if (partly_unknown) brick.smooth.unmeasured.resize(kBrickSamples, 0.0f);
  for (const std::uint16_t i : index)
    if (!brick.smooth.unmeasured.empty()) brick.smooth.unmeasured[i] = 0.0f;
  for (std::uint32_t slot = 0; slot < labels.size(); ++slot) {
    float* row = labels[slot] == kUnknown ? brick.smooth.unmeasured.data() : brick.shares.row(labels[slot]);
    for (std::size_t k = 0; k < index.size(); ++k)
      row[index[k]] = group.block == kNoBlock ? 1.0f : batch_.row(group.block, slot)[group.lane + k];
  }
  if (partly_unknown) fill_unmeasured(brick, index, points, scratch);
  std::array<float, kBrickSamples> best;
  best.fill(-1.0f);
  for (std::size_t row = 0; row < brick.shares.palette.size(); ++row) {
    const float* share = brick.shares.share.data() + row * kBrickSamples;
    for (std::size_t k = 0; k < index.size(); ++k) {
      if (share[index[k]] <= best[k]) continue;
      best[k] = share[index[k]];
      brick.label[index[k]] = brick.shares.palette[row];
    }
  }
  for (std::size_t k = 0; k < index.size(); ++k) {
    brick.cell[index[k]] = cell;
    brick.sampled.set(index[k]);
  }
  pin(brick, group, index, points);
}

/// f = known shares + unmeasured share * background (docs/pipeline/9-background.md).
void Sampler::fill_unmeasured(WorkBrick& brick, std::span<const std::uint16_t> index,
                              std::span<const Eigen::Vector3d> points, PointShares& scratch) const {
  if (background_ == nullptr) {
    scratch.labels.assign(1, kOutside);
    scratch.share.assign(points.size(), 1.0f);
  } else {
    background_->shares(points, scratch);
  }
  for (std::size_t l = 0; l < scratch.labels.size(); ++l) {
    const float* share = scratch.share.data() + l * points.size();
    float* row = brick.shares.row(scratch.labels[l]);
    for (std::size_t k = 0; k < index.size(); ++k) row[index[k]] += brick.smooth.unmeasured[index[k]] * share[k];
  }
}

}  // namespace sonoloft
