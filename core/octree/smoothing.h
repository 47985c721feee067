#pragma once
#include <array>
#include <vector>

#include "core/octree/bricks/brick_pool.h"

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
  using Row = std::array<float, kSide>;
  /// A value for each sample of the brick and of the two layers around it, in rows along x.
  using Block = std::array<float, kRows * kSide>;
  /// The same with one bit for each sample, bit x + kReach of a row.
  using RowBits = std::array<unsigned, kRows>;
  /// The bricks at -1, 0 and 1 in each axis, x fastest; null where there is none.
  using Around = std::array<const WorkBrick*, 27>;

  static std::size_t row_index(int y, int z);
  template <class Visit>
  static void for_rows(int margin, Visit visit);
  void gather_sampled();
  void gather_share(Label label);
  [[nodiscard]] std::vector<Label> labels_around() const;
  [[nodiscard]] SampleMask inner() const;
  static Row ones(unsigned bits);
  [[nodiscard]] Row second_differences(const Block& f, std::size_t row) const;
  void move(Label label, const SampleMask& movable, float* share, float* first_share);
  void keep_labels(const WorkBrick& brick, const SampleMask& samples);

  Around around_{};
  RowBits sampled_{};
  Block share_{}, second_{};  ///< of one label, and their second differences
  Brick result_;
};

}  // namespace sonoloft
