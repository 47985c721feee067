#pragma once
#include <array>
#include <vector>

#include "core/octree/bricks/brick_pool.h"
#include "core/slice/four.h"

namespace sonoloft {

/// Bi-Laplacian smoothing of the samples of bricks: f - 1/4 L(L f) for the share of every label, L the mean of the six
/// neighbours minus the sample itself; where one is not sampled, of those on the other axes. Samples within a finest
/// cell of a slice stay as they are, which keeps the contours. Of those with a finest cell beside them that was not
/// sampled whole the shares move and the label stays, which keeps the surface inside of what was sampled.
/// Shares add up to 1, so the first label's change is what the others' changes leave.
/// Keep one for many bricks: it holds the room to work in. Threads: one each. Source: Bermano, Vaxman, Gotsman 2011,
/// section 4.6.
class Smoother {
 public:
  /// Brings brick.smooth up to date. Reads the samples as taken up to two steps outside of the brick.
  /// @return the samples in which it changed
  SampleMask smooth(const BrickPool& bricks, WorkBrick& brick);

 private:
  static constexpr int kReach = 2;
  static constexpr int kSide = kBrickSize + 2 * kReach;
  static constexpr int kRows = kSide * kSide;
  /// A value for each sample of the brick and of the two layers around it, in rows along x.
  using Block = std::array<float, kRows * kSide>;
  /// The same with one bit for each sample, bit x + kReach of a row.
  using RowBits = std::array<unsigned, kRows>;
  /// The bricks at -1, 0 and 1 in each axis, x fastest; null where there is none.
  using Around = std::array<const WorkBrick*, 27>;
  /// A row with samples.
  struct Row {
    std::size_t index;                   ///< among those of a Block
    std::size_t left;                    ///< index in Around of the brick at x = -1 there
    std::size_t first;                   ///< index of the row's first sample in its brick
    std::array<unsigned, 3> both_sides;  ///< [axis] the samples of which both neighbours are sampled; not of outer rows
    unsigned movable;                    ///< bit x of the samples that move
  };

  static std::size_t row_index(int y, int z);
  template <class Visit>
  static void for_rows(int margin, Visit visit);
  void gather_sampled();
  void find_rows(const SampleMask& movable);
  void gather_share(Label label);
  [[nodiscard]] bool has_share() const;
  void find_labels();
  [[nodiscard]] SampleMask inner() const;
  static Four second_differences(const float* at, const std::array<unsigned, 3>& both_sides, int shift);
  void move(float* share, float* first_share);
  void keep_labels(const WorkBrick& brick, const SampleMask& samples);

  Around around_{};
  RowBits sampled_{};
  std::vector<Row> rows_;                       ///< the nearest first to those with samples that move
  std::array<std::size_t, kReach + 1> ends_{};  ///< [d] of the rows that lie at most d steps from these
  std::vector<Label> labels_;                   ///< with a share in the bricks around, ascending
  Block share_{}, second_{};                    ///< of one label, and their second differences
  Brick result_;
};

}  // namespace sonoloft
