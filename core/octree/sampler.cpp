#include "core/octree/sampler.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "core/slice/parallel.h"

namespace sonoloft {
Sampler::Sampler(const CellComplex& cells, const ContourSlopes* slopes, FieldEvaluator& evaluator,
                 const UnmeasuredFill& fill, const Eigen::Vector3d& origin_mm, double spacing_mm, int threads)
    : cells_(cells),
      sampled_(cells, slopes, fill),
      evaluator_(evaluator),
      fill_(fill),
      origin_mm_(origin_mm),
      spacing_mm_(spacing_mm),
      threads_(threads) {}

Result<void> Sampler::take(BrickPool& bricks, const std::vector<SampleJob>& jobs) {
  if (located_.size() < jobs.size()) located_.resize(jobs.size());
  parallel_for(jobs.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    const auto scratch = scratches_.take();
    for (std::size_t j = first; j < last; ++j) locate(jobs[j], bricks[jobs[j].brick].coord, *scratch, located_[j]);
  });

  const auto start = std::chrono::steady_clock::now();
  std::vector<std::size_t> first_group(1, 0);
  groups_.clear();
  for (std::uint32_t j = 0; j < jobs.size(); ++j) {
    for (const CellPoints& points : located_[j].cells)
      groups_.push_back({j, sampled_.find_or_add(points.cell), points.first, points.count, kNoBlock, 0, false});
    first_group.push_back(groups_.size());
    evaluated_ += located_[j].index.size();
  }
  sampled_.pack(batch_.cells, threads_);
  if (auto done = evaluate(bricks, jobs); !done) return done;
  field_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  parallel_for(jobs.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    const auto scratch = scratches_.take();
    for (std::size_t j = first; j < last; ++j) {
      WorkBrick& brick = bricks[jobs[j].brick];
      const SampleMask before = jobs[j].samples & brick.sampled;
      located_[j].first_taken = static_cast<std::uint32_t>((jobs[j].samples - before).count());
      brick.forget(before);
      for (std::size_t g = first_group[j]; g < first_group[j + 1]; ++g) store(brick, groups_[g], *scratch);
      name_labels(jobs[j].samples, brick.shares.palette, brick.shares.share, brick.label);
    }
  });
  first_taken_ = 0;
  for (std::size_t j = 0; j < jobs.size(); ++j) first_taken_ += located_[j].first_taken;
  return {};
}

Sampler::Axes Sampler::axes_mm(BrickCoord brick) const {
  const std::array<std::int32_t, 3> coord = {brick.x, brick.y, brick.z};
  Axes axes;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kBrickSize; ++i)
      axes[axis][static_cast<std::size_t>(i)] =
          origin_mm_[static_cast<Eigen::Index>(axis)] + spacing_mm_ * (kBrickSize * coord[axis] + i);
  return axes;
}

void Sampler::positions_mm(const Axes& axes, std::span<const std::uint16_t> samples,
                           std::vector<Eigen::Vector3d>& out) {
  out.resize(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k)
    out[k] = {axes[0][samples[k] & 7u], axes[1][samples[k] >> 3 & 7u], axes[2][samples[k] >> 6]};
}

void Sampler::locate(const SampleJob& job, BrickCoord brick, Scratch& scratch, Located& out) const {
  scratch.index.clear();
  job.samples.for_each([&](int i) { scratch.index.push_back(static_cast<std::uint16_t>(i)); });
  const Axes axes = axes_mm(brick);
  positions_mm(axes, scratch.index, scratch.points_mm);
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(axes[0].front(), axes[1].front(), axes[2].front()),
                                   Eigen::Vector3d(axes[0].back(), axes[1].back(), axes[2].back()));
  cells_.locate(bounds, scratch.points_mm, scratch.order, out.cells);
  out.index.resize(scratch.order.size());
  for (std::size_t i = 0; i < out.index.size(); ++i) out.index[i] = scratch.index[scratch.order[i]];
}

/// One block a cell, so that a cell's edges are read once for the points of all
/// bricks.
Result<void> Sampler::evaluate(const BrickPool& bricks, const std::vector<SampleJob>& jobs) {
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
      if (group.block == kNoBlock) continue;
      const Axes axes = axes_mm(bricks[jobs[group.job].brick].coord);
      const Eigen::Vector3d& centre = batch_.cells.centre_mm(group.packed);
      std::array<std::array<float, kBrickSize>, 3> from_centre;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < kBrickSize; ++i)
          from_centre[axis][i] = static_cast<float>(axes[axis][i] - centre[static_cast<Eigen::Index>(axis)]);
      const std::span<const std::uint16_t> index = samples_of(group);
      batch_.set_points(group.block, group.lane, group.count, [&](std::size_t k) {
        return Eigen::Vector3f(from_centre[0][index[k] & 7u], from_centre[1][index[k] >> 3 & 7u],
                               from_centre[2][index[k] >> 6]);
      });
    }
  });
  return evaluator_.evaluate(batch_);
}

/// What the samples of a group have of the label of a slot.
const float* Sampler::shares(const Group& group, std::size_t slot) const {
  static constexpr std::array<float, kBrickSamples> kAll = [] {
    std::array<float, kBrickSamples> all{};
    all.fill(1.0f);
    return all;
  }();
  if (group.block == kNoBlock) return kAll.data();
  return batch_.row(group.block, static_cast<std::uint32_t>(slot)).data() + group.lane;
}

/// Measures how far samples are from the slices that bound their cell, and marks those within one spacing.
void Sampler::pin(WorkBrick& brick, const Group& group) const {
  const Eigen::Vector3d lowest =
      origin_mm_ +
      spacing_mm_ * Eigen::Vector3d(kBrickSize * brick.coord.x, kBrickSize * brick.coord.y, kBrickSize * brick.coord.z);
  const Eigen::Vector3d centre = lowest + Eigen::Vector3d::Constant(0.5 * spacing_mm_ * (kBrickSize - 1));
  const std::span<const std::uint16_t> index = samples_of(group);
  std::vector<float>& before = brick.smooth.slice_steps;
  std::array<float, kBrickSamples> steps;
  std::fill_n(steps.begin(), index.size(), kFarFromSlices);
  bool any_near = !before.empty();
  for (const SampledCells::PinPlane& plane : sampled_.pins(group.packed)) {
    const double reach = 0.5 * spacing_mm_ * (kBrickSize - 1) * plane.normal.lpNorm<1>();
    if (std::abs(plane.normal.dot(centre) + plane.offset_mm) > reach + 1.001 * kFarFromSlices * spacing_mm_) continue;
    any_near = true;
    const double at_lowest = (plane.normal.dot(lowest) + plane.offset_mm) / spacing_mm_;
    Axes climb;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t x = 0; x < kBrickSize; ++x)
        climb[axis][x] = plane.normal[static_cast<Eigen::Index>(axis)] * static_cast<double>(x);
    for (std::size_t k = 0; k < index.size(); ++k) {
      const double away =
          at_lowest + (climb[0][index[k] & 7u] + climb[1][index[k] >> 3 & 7u] + climb[2][index[k] >> 6]);
      steps[k] = std::min(steps[k], static_cast<float>(std::abs(away)));
    }
  }
  if (!any_near) return;
  before.resize(kBrickSamples, kFarFromSlices);
  for (std::size_t k = 0; k < index.size(); ++k) {
    const std::size_t at = index[k];
    brick.pinned.layer[at >> 6] |= std::uint64_t{steps[k] < 1} << (at & 63);
    brick.slices_moved.layer[at >> 6] |= std::uint64_t{steps[k] != before[at]} << (at & 63);
    before[at] = steps[k];
  }
}

void Sampler::store(WorkBrick& brick, Group& group, Scratch& scratch) const {
  const std::span<const std::uint16_t> index = samples_of(group);
  const std::span<const Label> labels = batch_.cells.labels(group.packed);
  const bool partly_unknown = labels.back() == kUnknown;
  if (partly_unknown) brick.smooth.unmeasured.resize(kBrickSamples, 0.0f);  // and 0 at these samples: forget()
  for (std::size_t slot = 0; slot < labels.size(); ++slot) {
    float* row = labels[slot] == kUnknown ? brick.smooth.unmeasured.data() : brick.shares.row(labels[slot]);
    const float* share = shares(group, slot);
    for (std::size_t k = 0; k < index.size(); ++k) row[index[k]] += share[k];
  }
  if (partly_unknown) fill_unmeasured(brick, group, scratch);
  SampleMask samples;
  for (const std::uint16_t i : index) samples.set(i);
  group.is_new = brick.add(static_cast<std::uint32_t>(sampled_.cell(group.packed)), samples);
  pin(brick, group);
}

}  // namespace sonoloft
