#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/lattice_position.h"
#include "core/mesh/vertices/contour_snap.h"
#include "core/mesh/vertices/sample_block.h"

namespace sonoloft {

/// An edge of the lattice whose ends differ in label. It belongs to the brick of its lower end.
struct MixedEdge {
  std::uint16_t cell;  ///< sample_index of the lower end
  std::uint16_t axis;
  Label lower, upper;
  std::uint16_t crossing;  ///< where the labels meet: 1/65536 of the way from the lower end
  friend bool operator==(const MixedEdge&, const MixedEdge&) = default;
};

/// What its own samples and the layer above say about the cells of one brick: all that is drawn from them. Only mixed
/// cells with 8 sampled corners.
struct BrickCells {
  std::vector<std::uint16_t> slot;           ///< [kBrickSamples] index into simple_cells, or kNoSlot; [0] if #S = 0
  std::vector<std::uint16_t> simple_cells;   ///< [#S] sample_index, ascending
  std::vector<std::uint16_t> complex_cells;  ///< [#C] sample_index, ascending
  std::vector<CellSamples> complex_samples;  ///< [#C] 0 beyond label_count
  std::vector<MixedEdge> edges;              ///< those that the brick owns
  std::vector<CellPoint> placed;             ///< [#S] vertices
  std::vector<std::uint8_t> pull;            ///< [#S] faces towards whose cells the vertex is drawn
  std::vector<std::uint8_t> equations;       ///< [#S] 0..kMaxEquations
  std::vector<float> gaps;                   ///< [sum of equations][8]
  std::vector<ContourSpan> spans;            ///< of the contours, ascending by cell

  static constexpr std::uint16_t kNoSlot = 0xFFFF;
  void clear();
  [[nodiscard]] bool same_as(const BrickCells& other) const;  ///< in every byte
};

/// Room to work in for BrickNet::read(), used again for brick after brick.
struct ReadScratch {
  SampleBlock block;
  BrickCells cells;
  std::vector<LabelPair> pairs;  ///< [#S] both kNotSampled where there are more than two
};

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
  [[nodiscard]] bool empty() const { return cells_.simple_cells.empty() && cells_.complex_cells.empty(); }
  /// The finished vertex of a cell by its sample_index, null when the cell is not simple.
  [[nodiscard]] const CellPoint* vertex(std::size_t cell) const { return vertex_in(relaxed_, cell); }

 private:
  [[nodiscard]] const CellPoint* vertex_in(const std::vector<CellPoint>& vertices, std::size_t cell) const {
    const std::uint16_t slot = cells_.slot.empty() ? BrickCells::kNoSlot : cells_.slot[cell];
    return slot == BrickCells::kNoSlot ? nullptr : &vertices[slot];
  }
  [[nodiscard]] unsigned sides_of_change(const std::vector<CellPoint>& relaxed) const;
  bool mean_beside(std::size_t s, const std::array<const BrickNet*, 6>& beside, Eigen::Vector3f& mean) const;

  BrickCells cells_;
  std::vector<CellPoint> relaxed_;            ///< [#relaxed_cells_]
  std::vector<std::uint16_t> relaxed_cells_;  ///< sample_index, ascending; simple_cells when relaxed_ was made
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
