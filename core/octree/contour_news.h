#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/octree/bricks/brick_pool.h"
#include "core/octree/bricks/index_set.h"
#include "core/octree/bricks/octant_growth.h"

namespace sonoloft {

/// The contours on walls, and what became of them since the samples were last renewed. Bricks hold their pieces.
class ContourNews {
 public:
  ContourNews(const Eigen::Vector3d& origin_mm, double spacing_mm) : origin_mm_(origin_mm), spacing_mm_(spacing_mm) {}

  /// Those on the walls that a slice made.
  void add(const CellComplex& cells, const CellComplex::Delta& delta);
  /// Forgets those on the walls that went with a slice. @cost O(bricks + contour pieces in those that a region reaches)
  void remove(const CellComplex& cells, const CellComplex::Withdrawal& withdrawal, BrickPool& bricks);

  /// Hands the pieces of the new ones to the bricks that they run through, and switches octants on and off.
  void trace(BrickPool& bricks, OctantGrowth& growth);
  /// Bricks of which contours came or went.
  [[nodiscard]] const std::vector<std::uint32_t>& bricks() const { return changed_.items(); }
  void clear_changes() { changed_.clear(); }

 private:
  struct Contour {
    Eigen::Vector3d a, b;  ///< reference, mm
    Label lower, upper;
    SliceId slice;
  };
  class Region;
  void forget(const Region& region, WorkBrick& brick, std::uint32_t index);
  void trace(const Contour& contour, BrickPool& bricks, OctantGrowth& growth, std::uint32_t& near);
  void sort_pieces(BrickPool& bricks) const;

  Eigen::Vector3d origin_mm_;
  double spacing_mm_;
  std::vector<Contour> new_;  ///< not traced yet
  IndexSet changed_;
  IndexSet unseeded_;  ///< bricks with octants through which contours ran, and may run no more
};

}  // namespace sonoloft
