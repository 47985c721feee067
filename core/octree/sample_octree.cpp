#include "core/octree/sample_octree.h"

#include <algorithm>
#include <chrono>

#include "core/octree/background_news.h"
#include "core/octree/bricks/brick_pool.h"
#include "core/octree/bricks/index_set.h"
#include "core/octree/bricks/octant_growth.h"
#include "core/octree/contour_news.h"
#include "core/octree/sampler.h"
#include "core/octree/smoothing.h"
#include "core/slice/parallel.h"
#include "core/slice/scratch_pool.h"

namespace sonoloft {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Samples that were taken anew or forgotten.
class TouchedSamples {
 public:
  void add(std::uint32_t brick, const SampleMask& samples) {
    if (brick >= samples_.size()) samples_.resize(brick + 1);
    samples_[brick] = samples_[brick] | samples;
    bricks_.add(brick);
  }
  [[nodiscard]] const std::vector<std::uint32_t>& bricks() const { return bricks_.items(); }
  [[nodiscard]] const SampleMask& of(std::uint32_t brick) const { return samples_[brick]; }

 private:
  IndexSet bricks_;
  std::vector<SampleMask> samples_;  ///< [brick]
};

}  // namespace

struct SampleOctree::State {
  State(const Eigen::Vector3d& origin, double spacing)
      : origin_mm(origin), spacing_mm(spacing), contours(origin, spacing), background(origin, spacing) {}

  Eigen::Vector3d origin_mm;
  double spacing_mm;
  ContourNews contours;
  BackgroundNews background;
  BrickPool bricks;
  std::vector<std::vector<std::uint32_t>> bricks_of_cell;  ///< [cell] bricks that may have samples in it
  std::size_t samples = 0;
  IndexSet changed_cells;         ///< noted since the last update ...
  std::size_t stale_samples = 0;  ///< ... and how many samples lie in them
  ScratchPool<Smoother> smoothers;

  void add_changed(CellId cell);
  void seed_background(OctantGrowth& growth);
  [[nodiscard]] SampleMask stale_in(const WorkBrick& brick) const;
  [[nodiscard]] std::vector<SampleJob> stale_jobs();
  void add_missing(OctantGrowth& growth, std::vector<SampleJob>& jobs, int threads) const;
  void drop_unneeded(OctantGrowth& growth, TouchedSamples& touched);
  [[nodiscard]] std::vector<BrickCoord> smooth(const TouchedSamples& touched, int threads, std::size_t& smoothed);
};

SampleOctree::SampleOctree(const Eigen::Vector3d& origin_mm, double spacing_mm)
    : state_(std::make_unique<State>(origin_mm, spacing_mm)) {}
SampleOctree::~SampleOctree() = default;
SampleOctree::SampleOctree(SampleOctree&&) noexcept = default;
SampleOctree& SampleOctree::operator=(SampleOctree&&) noexcept = default;

void SampleOctree::note(const CellComplex& cells, const CellComplex::Delta& delta) {
  for (const CellId cell : delta.divided) state_->add_changed(cell);
  state_->contours.add(cells, delta);
}

void SampleOctree::note(const CellComplex& cells, const CellComplex::Withdrawal& withdrawal) {
  for (const CellId cell : withdrawal.removed) state_->add_changed(cell);
  state_->contours.remove(cells, withdrawal, state_->bricks);
}

void SampleOctree::note(const Background& background, std::span<const BackgroundChange> changes) {
  state_->background.add(background, changes);
}

void SampleOctree::note(std::span<const CellId> changed) {
  for (const CellId cell : changed) state_->add_changed(cell);
}

void SampleOctree::State::add_changed(CellId id) {
  const auto cell = static_cast<std::uint32_t>(id);
  if (!changed_cells.add(cell) || cell >= bricks_of_cell.size()) return;
  for (const std::uint32_t index : bricks_of_cell[cell])
    for (const SamplesInCell& in : bricks[index].in_cells)
      if (in.cell == cell) stale_samples += static_cast<std::size_t>(in.samples.count());
}

void SampleOctree::State::seed_background(OctantGrowth& growth) {
  for (const Octant& octant : background.octants()) {
    if (background.seeds(octant)) {
      const std::uint32_t index = bricks.find_or_add(octant.brick());
      bricks[index].background_seeds |= octant.bit();
      growth.activate(index, octant.bit());
    } else if (const std::uint32_t index = bricks.find(octant.brick()); index != kNoBrick) {
      bricks[index].background_seeds &= ~octant.bit();
      growth.unseed(index);
    }
  }
}

/// Samples of a brick whose cell was cut since they were taken, or that the background fills in part and has news of.
SampleMask SampleOctree::State::stale_in(const WorkBrick& brick) const {
  SampleMask stale;
  for (const SamplesInCell& in : brick.in_cells)
    if (changed_cells.contains(in.cell)) stale = stale | in.samples;
  const std::vector<float>& unmeasured = brick.smooth.unmeasured;
  if (unmeasured.empty()) return stale;
  const Eigen::Vector3i base = kBrickSize * Eigen::Vector3i(brick.coord.x, brick.coord.y, brick.coord.z);
  brick.sampled.for_each([&](int i) {
    const Eigen::Vector3i at = base + Eigen::Vector3i(i & 7, i >> 3 & 7, i >> 6);
    if (unmeasured[static_cast<std::size_t>(i)] > 0.0f &&
        background.changed(origin_mm + spacing_mm * at.cast<double>()))
      stale.set(i);
  });
  return stale;
}

std::vector<SampleJob> SampleOctree::State::stale_jobs() {
  std::vector<SampleJob> jobs;
  IndexSet seen_bricks;
  const auto look_at = [&](std::uint32_t index) {
    if (!seen_bricks.add(index)) return;
    if (const SampleMask stale = stale_in(bricks[index]); stale.any()) jobs.push_back({index, stale});
  };
  for (const std::uint32_t cell : changed_cells.items()) {
    if (cell >= bricks_of_cell.size()) continue;
    for (const std::uint32_t index : bricks_of_cell[cell]) look_at(index);
    bricks_of_cell[cell].clear();
  }
  for (const BrickCoord& coord : background.bricks())
    if (const std::uint32_t index = bricks.find(coord); index != kNoBrick) look_at(index);
  return jobs;
}

/// Adds the samples that active octants still lack.
void SampleOctree::State::add_missing(OctantGrowth& growth, std::vector<SampleJob>& jobs, int threads) const {
  const IndexSet disturbed = growth.take_disturbed();
  const auto& items = disturbed.items();
  std::vector<SampleMask> missing(items.size());
  parallel_for(items.size(), 64, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) missing[n] = growth.needed(bricks[items[n]]) - bricks[items[n]].sampled;
  });
  std::vector<std::uint32_t> job_of(bricks.capacity(), kNoBrick);
  for (std::uint32_t j = 0; j < jobs.size(); ++j) job_of[jobs[j].brick] = j;
  for (std::size_t n = 0; n < items.size(); ++n) {
    if (const std::uint32_t j = job_of[items[n]]; j != kNoBrick)
      jobs[j].samples = jobs[j].samples | missing[n];
    else if (missing[n].any())
      jobs.push_back({items[n], missing[n]});
  }
}

/// Forgets samples that pruning left without an active octant, and bricks without samples.
void SampleOctree::State::drop_unneeded(OctantGrowth& growth, TouchedSamples& touched) {
  const IndexSet disturbed = growth.take_disturbed();
  for (const std::uint32_t index : disturbed.items()) {
    WorkBrick& brick = bricks[index];
    const SampleMask unneeded = brick.sampled - growth.needed(brick);
    if (unneeded.any()) touched.add(index, unneeded);
    brick.forget(unneeded);
    samples -= static_cast<std::size_t>(unneeded.count());
  }
}

/// Smooths what changed and what smoothing carries the change into.
/// @return bricks with a cell of which a corner or a contour changed, ascending
std::vector<BrickCoord> SampleOctree::State::smooth(const TouchedSamples& touched, int threads, std::size_t& smoothed) {
  IndexSet reached;
  for (const std::uint32_t index : touched.bricks())
    for (int i = 0; i < 27; ++i) {
      const std::uint32_t near = bricks[index].around[static_cast<std::size_t>(i)];
      if (near != kNoBrick && (touched.of(index) & samples_near(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)).any())
        reached.add(near);
    }
  const auto& items = reached.items();
  std::vector<SampleMask> changed(items.size());
  parallel_for(items.size(), 8, threads, [&](std::size_t first, std::size_t last) {
    const auto smoother = smoothers.take();
    for (std::size_t n = first; n < last; ++n) changed[n] = smoother->smooth(bricks, bricks[items[n]]);
  });
  smoothed = items.size();
  IndexSet differ;
  for (const std::uint32_t index : contours.bricks()) differ.add(index);
  for (std::size_t n = 0; n < items.size(); ++n)
    for (int i = 0; i < 8 && changed[n].any(); ++i) {
      const std::uint32_t below = bricks[items[n]].around[beside(-(i & 1), -((i >> 1) & 1), -(i >> 2))];
      if (below != kNoBrick && (changed[n] & corners_for_below(i & 1, (i >> 1) & 1, i >> 2)).any()) differ.add(below);
    }
  std::vector<BrickCoord> result;
  for (const std::uint32_t index : differ.items()) result.push_back(bricks[index].coord);
  std::sort(result.begin(), result.end());
  for (const std::uint32_t index : items)
    if (!bricks[index].sampled.any() && bricks[index].seeds() == 0) bricks.remove(index);
  return result;
}

Result<SampleOctree::Change> SampleOctree::update(const CellComplex& cells, const ContourSlopes* slopes,
                                                  FieldEvaluator& evaluator, const UnmeasuredFill& fill, int threads) {
  State& s = *state_;
  const auto start = Clock::now();
  s.bricks_of_cell.resize(cells.cell_bound());
  Sampler sampler(cells, slopes, evaluator, fill, s.origin_mm, s.spacing_mm, threads);
  OctantGrowth growth(s.bricks);
  TouchedSamples touched;
  std::vector<SampleJob> jobs = s.stale_jobs();
  s.seed_background(growth);
  s.contours.trace(s.bricks, growth);
  for (s.add_missing(growth, jobs, threads); !jobs.empty(); s.add_missing(growth, jobs, threads)) {
    if (auto taken = sampler.take(s.bricks, jobs); !taken) return tl::unexpected<Error>(taken.error());
    s.samples += sampler.first_taken();
    sampler.for_new_cells(jobs,
                          [&](std::uint32_t cell, std::uint32_t brick) { s.bricks_of_cell[cell].push_back(brick); });
    for (const SampleJob& job : jobs) touched.add(job.brick, job.samples);
    growth.follow(jobs, threads);
    jobs.clear();
  }
  growth.prune();
  s.drop_unneeded(growth, touched);
  parallel_for(touched.bricks().size(), 64, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t n = first; n < last; ++n) s.bricks[touched.bricks()[n]].shares.drop_empty_rows();
  });
  s.changed_cells.clear();
  s.stale_samples = 0;
  s.background.clear_changes();

  Change change;
  change.evaluated = sampler.evaluated();
  change.edge_evaluations = sampler.edge_evaluations();
  change.field_ms = sampler.field_ms();
  change.octree_ms = ms_since(start) - change.field_ms;
  const auto smoothing = Clock::now();
  change.bricks = s.smooth(touched, threads, change.smoothed_bricks);
  change.smooth_ms = ms_since(smoothing);
  s.contours.clear_changes();
  return change;
}

const Brick* SampleOctree::find(BrickCoord coord) const {
  const std::uint32_t index = state_->bricks.find(coord);
  return index == kNoBrick || !state_->bricks[index].sampled.any() ? nullptr : &state_->bricks[index].smooth;
}

std::span<const ContourPiece> SampleOctree::contours(BrickCoord coord) const {
  const std::uint32_t index = state_->bricks.find(coord);
  return index == kNoBrick ? std::span<const ContourPiece>() : state_->bricks[index].contours;
}

Eigen::Vector3d SampleOctree::origin_mm() const {
  return state_->origin_mm;
}
double SampleOctree::spacing_mm() const {
  return state_->spacing_mm;
}
std::size_t SampleOctree::sample_count() const {
  return state_->samples;
}
std::size_t SampleOctree::stale_count() const {
  return state_->stale_samples;
}
std::size_t SampleOctree::brick_count() const {
  return state_->bricks.size();
}

}  // namespace sonoloft
