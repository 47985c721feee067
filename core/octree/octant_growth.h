#pragma once
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "core/octree/brick_pool.h"
#include "core/octree/index_set.h"
#include "core/octree/octants.h"

namespace sonoloft {

/// Which octants of a pool are active: seeds, through which a contour or a surface of the background runs, and those
/// that a chain of mixed faces joins to one of them. Nothing else, so that the active set is a function of the seeds
/// and the samples. Lives for one update.
class OctantGrowth {
 public:
  explicit OctantGrowth(BrickPool& bricks) : bricks_(bricks) {}

  void activate(Octant octant);
  /// The octant is no seed any more: it stays active only if a chain joins it to one.
  void unseed(Octant octant) { faces_changed_.add(bricks_.find(octant.brick())); }
  /// Bricks whose set of needed samples may have changed since the last call.
  [[nodiscard]] IndexSet take_disturbed();
  /// The samples of a brick that are corners of active octants, its own and those of the bricks below.
  [[nodiscard]] SampleMask needed(const WorkBrick& brick) const;

  /// Samples of these bricks are new: switches on the octants behind faces that became mixed.
  void follow(const std::vector<std::uint32_t>& resampled, int threads);
  /// At the end: switches off the octants that lost their last chain to a seed.
  void prune();

 private:
  void disturb(Octant octant);
  void refresh_faces(WorkBrick& brick) const;
  [[nodiscard]] std::vector<Octant> chain(Octant start, bool& reaches_seed) const;

  BrickPool& bricks_;
  IndexSet disturbed_;
  IndexSet faces_changed_;  ///< bricks whose mixed faces or seeds may have changed in this update
  std::unordered_set<Octant, OctantHash> joined_;
};

}  // namespace sonoloft
