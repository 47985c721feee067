#include "core/octree/sampling_round.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/slice/parallel.h"

namespace sonoloft {

Sampler::Sampler(const CellComplex& cells, FieldEvaluator& evaluator, const Eigen::Vector3d& origin_mm,
                 double spacing_mm, int threads)
    : cells_(cells),
      evaluator_(evaluator),
      origin_mm_(origin_mm),
      spacing_mm_(spacing_mm),
      threads_(threads),
      packed_of_cell_(cells.cell_count(), kNoCell) {}

Result<std::vector<std::vector<std::uint32_t>>> Sampler::take(BrickPool& bricks, const std::vector<SampleJob>& jobs) {
  locate(bricks, jobs);
  std::vector<std::vector<std::uint32_t>> found(jobs.size());
  parallel_for(jobs.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    for (std::size_t j = first; j < last; ++j) {
      for (std::size_t p = first_of_job_[j]; p < first_of_job_[j + 1]; ++p)
        found[j].push_back(static_cast<std::uint32_t>(cell_[p]));
      std::sort(found[j].begin(), found[j].end());
      found[j].erase(std::unique(found[j].begin(), found[j].end()), found[j].end());
    }
  });

  const auto start = std::chrono::steady_clock::now();
  pack(found);
  if (auto done = evaluate(); !done) return tl::unexpected<Error>(done.error());
  field_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  parallel_for(jobs.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    for (std::size_t j = first; j < last; ++j) store(bricks[jobs[j].brick], jobs[j].samples, first_of_job_[j]);
  });
  evaluated_ += points_.size();
  return found;
}

void Sampler::locate(const BrickPool& bricks, const std::vector<SampleJob>& jobs) {
  first_of_job_.assign(1, 0);
  for (const SampleJob& job : jobs)
    first_of_job_.push_back(first_of_job_.back() + static_cast<std::size_t>(job.samples.count()));
  points_.resize(first_of_job_.back());
  cell_.resize(points_.size());
  parallel_for(jobs.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    for (std::size_t j = first; j < last; ++j) {
      const BrickCoord coord = bricks[jobs[j].brick].coord;
      const Eigen::Vector3d base = Eigen::Vector3i(coord.x, coord.y, coord.z).cast<double>() * kBrickSize;
      Eigen::AlignedBox3d bounds;
      std::size_t p = first_of_job_[j];
      jobs[j].samples.for_each([&](int index) {
        const Eigen::Vector3d offset(index & 7, (index >> 3) & 7, index >> 6);
        points_[p] = origin_mm_ + spacing_mm_ * (base + offset);
        bounds.extend(points_[p++]);
      });
      const std::size_t count = p - first_of_job_[j];
      cells_.locate(bounds, {points_.data() + first_of_job_[j], count}, {cell_.data() + first_of_job_[j], count});
    }
  });
}

void Sampler::pack(const std::vector<std::vector<std::uint32_t>>& found) {
  for (const auto& cells : found)
    for (const std::uint32_t cell : cells) {
      if (packed_of_cell_[cell] != kNoCell) continue;
      cells_.faces(CellId{cell}, faces_);
      packed_of_cell_[cell] = batch_.cells.add(faces_, cells_.centre(CellId{cell}));
      CellWalls walls{static_cast<std::uint32_t>(pins_.size()), 0};
      for (const CellFace& face : faces_) {
        if (static_cast<std::uint32_t>(face.plane) < 6 || face.label == kUnknown) continue;  // a wall of the box
        const Eigen::Vector3d normal = face.image_to_reference->linear().col(2);
        pins_.push_back({normal, -normal.dot(face.image_to_reference->translation())});
        ++walls.pin_count;
      }
      walls_.push_back(walls);
    }
}

/// Sorts the points by cell, so that each cell's edges are read once for all of its points.
Result<void> Sampler::evaluate() {
  std::vector<std::uint32_t> first_of_cell(batch_.cells.size() + 1, 0);
  block_.assign(points_.size(), kNoCell);
  lane_.resize(points_.size());
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const std::uint32_t packed = packed_of_cell_[static_cast<std::uint32_t>(cell_[p])];
    if (!batch_.cells.constant(packed)) lane_[p] = first_of_cell[packed + 1]++;
  }
  for (std::size_t c = 1; c < first_of_cell.size(); ++c) first_of_cell[c] += first_of_cell[c - 1];
  std::vector<Eigen::Vector3d> sorted(first_of_cell.back());
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const std::uint32_t packed = packed_of_cell_[static_cast<std::uint32_t>(cell_[p])];
    if (!batch_.cells.constant(packed)) sorted[first_of_cell[packed] + lane_[p]] = points_[p];
  }
  batch_.clear_points();
  std::vector<std::uint32_t> block_of_cell(batch_.cells.size(), kNoCell);
  for (std::uint32_t c = 0; c < batch_.cells.size(); ++c)
    if (const std::size_t count = first_of_cell[c + 1] - first_of_cell[c]; count > 0)
      block_of_cell[c] = batch_.add_points(c, {sorted.data() + first_of_cell[c], count});
  for (std::size_t p = 0; p < points_.size(); ++p)
    block_[p] = block_of_cell[packed_of_cell_[static_cast<std::uint32_t>(cell_[p])]];
  if (batch_.blocks.empty()) return {};
  return evaluator_.evaluate(batch_);
}

bool Sampler::pinned(std::uint32_t packed, const Eigen::Vector3d& point) const {
  const CellWalls& walls = walls_[packed];
  for (std::uint32_t i = walls.first_pin; i < walls.first_pin + walls.pin_count; ++i)
    if (std::abs(pins_[i].normal.dot(point) + pins_[i].offset_mm) < spacing_mm_) return true;
  return false;
}

void Sampler::store(WorkBrick& brick, const SampleMask& samples, std::size_t first) {
  std::size_t p = first;
  samples.for_each([&](int index) {
    const auto at = static_cast<std::size_t>(index);
    const auto cell = static_cast<std::uint32_t>(cell_[p]);
    const std::uint32_t packed = packed_of_cell_[cell];
    for (std::size_t row = 0; row < brick.shares.palette.size(); ++row)
      brick.shares.share[row * kBrickSamples + at] = 0.0f;
    const std::span<const Label> labels = batch_.cells.labels(packed);
    Label best = labels.front();
    float best_share = -1.0f;
    for (std::uint32_t slot = 0; slot < labels.size() && labels[slot] != kUnknown; ++slot) {
      const float share = block_[p] == kNoCell ? 1.0f : batch_.row(block_[p], slot)[lane_[p]];
      brick.shares.row(labels[slot])[at] = share;
      if (share > best_share) {
        best_share = share;
        best = labels[slot];
      }
    }
    brick.cell[at] = cell;
    brick.label[at] = best;
    brick.sampled.set(index);
    pinned(packed, points_[p]) ? brick.pinned.set(index) : brick.pinned.reset(index);
    ++p;
  });
}

}  // namespace sonoloft
