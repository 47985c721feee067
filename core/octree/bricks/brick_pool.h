#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/octree/brick.h"
#include "core/octree/bricks/octants.h"

namespace sonoloft {

inline constexpr std::uint32_t kNoBrick = 0xFFFFFFFF;

/// Shares of the labels that occur in a brick.
struct ShareTable {
  std::vector<Label> palette;  ///< [#P] ascending
  std::vector<float> share;    ///< [#P][kBrickSamples]

  /// The row of a label, added with shares 0 when it is new.
  [[nodiscard]] float* row(Label label);
  /// The row of a label, or null.
  [[nodiscard]] const float* find(Label label) const;
  /// Removes the rows of nothing but 0, so that the table is a function of the shares.
  void drop_empty_rows();
};

/// Names of some samples the label with the largest share, the lowest of equals.
/// @param share  [#palette][kBrickSamples] @pre the palette is not empty where samples are
void name_labels(const SampleMask& samples, std::span<const Label> palette, std::span<const float> share,
                 std::span<Label, kBrickSamples> label);

/// Samples of a brick that lie in one convex cell.
struct SamplesInCell {
  std::uint32_t cell;
  SampleMask samples;
};

/// Index of the brick at (x, y, z) from another one, each -1, 0 or 1, among the 27 around that.
constexpr std::size_t beside(int x, int y, int z) {
  return static_cast<std::size_t>((x + 1) + 3 * (y + 1) + 9 * (z + 1));
}

/// Samples of one brick to be taken, or just taken.
struct SampleJob {
  std::uint32_t brick;
  SampleMask samples;
};

/// All that is known of a brick: what was sampled, and what smoothing made of it.
struct WorkBrick {
  BrickCoord coord{};
  std::array<std::uint32_t, 27> around;     ///< [beside()] index of the brick there, kNoBrick; its own in the middle
  OctantMask contour_seeds = 0;             ///< octants that a contour runs through
  OctantMask background_seeds = 0;          ///< octants that a surface of the background runs through
  OctantMask active = 0;                    ///< octants whose corners are sampled
  std::array<OctantMask, 6> mixed_faces{};  ///< [face] see mixed_faces()
  OctantMask stale_faces = 0;               ///< octants of which the mixed faces are not up to date
  SampleMask sampled;
  SampleMask pinned;                       ///< within a finest cell of a slice: smoothing leaves it alone
  SampleMask slices_moved;                 ///< whose distance from the slices changed since they were smoothed
  std::vector<SamplesInCell> in_cells;     ///< none empty
  std::array<Label, kBrickSamples> label;  ///< as sampled; kNotSampled
  ShareTable shares;                       ///< as sampled; 0 where not
  std::vector<ContourPiece> contours;      ///< in its cells
  Brick smooth;                            ///< what the mesh sees

  [[nodiscard]] OctantMask seeds() const { return contour_seeds | background_seeds; }
  /// Samples that were found in a cell. @return whether it had none here
  bool add(std::uint32_t cell, const SampleMask& samples);
  /// Samples that are taken again, or no more.
  void forget(const SampleMask& samples);
};

/// The bricks by coordinate and by index. Indices of removed bricks are used again.
class BrickPool {
 public:
  [[nodiscard]] std::uint32_t find(BrickCoord coord) const {
    const auto it = index_.find(coord);
    return it == index_.end() ? kNoBrick : it->second;
  }
  std::uint32_t find_or_add(BrickCoord coord);
  void remove(std::uint32_t brick);

  /// The brick at (x, y, z) from `brick`, each -1, 0 or 1.
  std::uint32_t find_or_add_beside(const WorkBrick& brick, int x, int y, int z) {
    const std::uint32_t there = brick.around[beside(x, y, z)];
    return there != kNoBrick ? there : find_or_add({brick.coord.x + x, brick.coord.y + y, brick.coord.z + z});
  }

  [[nodiscard]] WorkBrick& operator[](std::uint32_t brick) { return *bricks_[brick]; }
  [[nodiscard]] const WorkBrick& operator[](std::uint32_t brick) const { return *bricks_[brick]; }
  [[nodiscard]] std::size_t capacity() const { return bricks_.size(); }  ///< indices are below this
  /// Of all bricks, ascending.
  [[nodiscard]] std::vector<std::uint32_t> indices() const;
  [[nodiscard]] std::size_t size() const { return index_.size(); }

 private:
  void find_around(WorkBrick& brick) const;
  void name_to_neighbours(const WorkBrick& brick, std::uint32_t name);

  std::unordered_map<BrickCoord, std::uint32_t, BrickCoordHash> index_;
  std::vector<std::unique_ptr<WorkBrick>> bricks_;
  std::vector<std::uint32_t> free_;
};

}  // namespace sonoloft
