#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/lattice_position.h"
#include "core/mesh/vertices/brick_cells.h"

namespace sonoloft {

/// The cells of one brick, and their vertices smoothed against those of the cells beside them.
class BrickNet {
 public:
  /// Finds the mixed cells, places their vertices, and notes which contours run through them. True if anything differs
  /// from what was read before.
  bool read(ReadScratch& scratch, const SampleLattice& lattice, const BrickCoord& coord);

  /// Smooths the vertices by one step and puts those of cells with a contour on it. True if any of them ends elsewhere
  /// than before.
  /// @param beside  the nets of the bricks at -x +x -y +y -z +z, null where there is none
  bool relax(const std::array<const BrickNet*, 6>& beside);

  /// Sides of the brick (bit 2 * axis + (1 for the upper one)) with a cell whose vertex the last relax() moved, made or
  /// removed: beyond them, chunks are drawn anew.
  [[nodiscard]] unsigned changed_sides() const { return changed_sides_; }

  [[nodiscard]] const BrickCells& cells() const { return cells_; }
  [[nodiscard]] bool empty() const { return cells_.simple.empty() && cells_.complex_cells.empty(); }
  /// The finished vertex of a cell by its sample_index, null when the cell is not simple.
  [[nodiscard]] const CellPoint* vertex(std::size_t cell) const {
    return cells_.is_simple(cell) ? &relaxed_[cells_.slot[cell]].vertex : nullptr;
  }

 private:
  struct RelaxedCell {
    std::uint16_t index;  ///< sample_index
    CellPoint vertex;
    friend bool operator==(const RelaxedCell&, const RelaxedCell&) = default;
  };
  /// The vertices of the cells beside those of one GapLanes that draw on theirs, relative to the cell, in 1/65536
  /// steps.
  struct Pulls {
    FourInts sum[3];
    FourInts count;
    FourInts beside_complex;  ///< not 0 where one of these cells is not simple
  };
  void find_pulls(const SimpleCell& cell, const std::array<const BrickNet*, 6>& beside, std::size_t lane,
                  Pulls& pulls) const;
  /// Relaxes the cells of one GapLanes, whose lines are the first of `lines`, and drops those from it.
  void relax_lanes(std::size_t block, const std::array<const BrickNet*, 6>& beside, std::span<const LineGaps>& lines);
  void put_on_contours();
  [[nodiscard]] unsigned sides_of_change(const std::vector<RelaxedCell>& before) const;

  BrickCells cells_;
  std::vector<RelaxedCell> relaxed_;  ///< ascending; as many as cells_.simple when they were relaxed
  unsigned changed_sides_ = 0;
};

/// A brick's net and the 26 around it, as one grid of cells -1..8 in each axis.
struct NetGrid {
  std::array<const BrickNet*, 27> nets;  ///< x fastest; null where there is none or none is read

  static constexpr std::size_t index(int dx, int dy, int dz) {
    return static_cast<std::size_t>(dx + 1 + 3 * (dy + 1) + 9 * (dz + 1));
  }

  /// The vertex of a cell, null when it is not a simple cell.
  [[nodiscard]] const CellPoint* vertex(LocalPoint cell) const {
    const BrickNet* net = nets[index(cell.x >> 3, cell.y >> 3, cell.z >> 3)];
    if (!net) return nullptr;
    return net->vertex(static_cast<std::size_t>(sample_index(cell.x & 7, cell.y & 7, cell.z & 7)));
  }
};

}  // namespace sonoloft
