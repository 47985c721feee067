#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/octree/bricks/brick_pool.h"
#include "core/octree/bricks/index_set.h"
#include "core/octree/bricks/octants.h"

namespace sonoloft {

/// Which octants of a pool are active: seeds, through which a contour or a surface of the background runs, and those
/// that a chain of mixed faces joins to one of them. Nothing else, so that the active set is a function of the seeds
/// and the samples. Lives for one update.
class OctantGrowth {
 public:
  explicit OctantGrowth(BrickPool& bricks) : bricks_(bricks) {}

  void activate(std::uint32_t brick, OctantMask octants);
  /// Octants of the brick are no seeds any more: they stay active only if a chain joins them to one.
  void unseed(std::uint32_t brick) { faces_changed_.add(brick); }
  /// Bricks whose set of needed samples may have changed since the last call.
  [[nodiscard]] IndexSet take_disturbed();
  /// The samples of a brick that are corners of active octants, its own and those of the bricks below.
  [[nodiscard]] SampleMask needed(const WorkBrick& brick) const;

  /// Samples were taken: switches on the octants behind faces that became mixed. One job a brick.
  void follow(const std::vector<SampleJob>& taken, int threads);
  /// At the end: switches off the octants that lost their last chain to a seed.
  void prune();

 private:
  void disturb(std::uint32_t brick, OctantMask octants);
  /// What follow() finds in one brick.
  struct Behind {
    bool active;
    OctantMask own;                    ///< octants behind its mixed faces
    std::array<OctantMask, 6> beside;  ///< [face] those in the brick across
  };
  void refresh_faces(WorkBrick& brick, const std::vector<SampleJob>& taken) const;
  [[nodiscard]] static Behind behind_faces(const WorkBrick& brick);
  [[nodiscard]] bool find_chain(std::uint32_t brick, OctantMask start);

  BrickPool& bricks_;
  IndexSet disturbed_;
  IndexSet faces_changed_;             ///< bricks whose mixed faces or seeds may have changed in this update
  std::vector<std::uint32_t> job_of_;  ///< [brick] among those followed, or kNoJob
  std::vector<OctantMask> joined_;     ///< [brick] octants known to be joined to a seed
  std::vector<OctantMask> chained_;    ///< [brick] octants of the chain that was sought last
  std::vector<std::uint32_t> chain_;   ///< the bricks that it runs through
};

}  // namespace sonoloft
