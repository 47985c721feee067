#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/lattice_position.h"
#include "core/mesh/vertices/cell_lanes.h"
#include "core/mesh/vertices/contour_snap.h"
#include "core/mesh/vertices/sample_block.h"

namespace sonoloft {

/// An edge of the lattice whose ends differ in label. It belongs to the brick of its lower end.
struct MixedEdge {
  std::uint16_t cell;  ///< sample_index of the lower end
  std::uint16_t axis;
  Label lower, upper;
  std::uint16_t crossing;  ///< where the labels meet: 1/65536 of the way from the lower end
};

struct SimpleCell {
  std::uint16_t index;  ///< sample_index
  std::uint16_t pull;   ///< faces towards whose cells the vertex is drawn
  CellPoint placed;     ///< the vertex
};

/// What its own samples and the layer above say about the cells of one brick: all that is drawn from them. Only mixed
/// cells with 8 sampled corners.
struct BrickCells {
  static constexpr std::uint16_t kNoSlot = 0xFFFF, kComplex = 0xFFFE;

  std::array<std::uint16_t, kBrickSamples> slot;  ///< index into simple, kComplex, or kNoSlot: not mixed
  std::vector<SimpleCell> simple;                 ///< [#S] ascending
  std::vector<GapLanes> gaps;                     ///< [#S / kFour, rounded up]
  std::vector<LineGaps> lines;                    ///< ascending
  std::vector<std::uint16_t> complex_cells;       ///< [#C] sample_index, ascending
  std::vector<CellSamples> complex_samples;       ///< [#C] 0 beyond label_count
  std::vector<MixedEdge> edges;                   ///< those that the brick owns
  std::vector<ContourSpan> spans;                 ///< of the contours, ascending by cell

  BrickCells() { slot.fill(kNoSlot); }
  [[nodiscard]] bool is_simple(std::size_t cell) const { return slot[cell] < kComplex; }
  void clear();
  [[nodiscard]] bool same_as(const BrickCells& other) const;  ///< in every byte
};

/// Room to work in for read_cells(), used again for brick after brick.
struct ReadScratch {
  SampleBlock block;
  BrickCells cells;
  std::vector<LabelPair> pairs;  ///< [#S] both kNotSampled where there are more than two
};

/// Finds the mixed cells of a brick, places their vertices, and notes which contours run through them: scratch.cells.
void read_cells(ReadScratch& scratch, const SampleLattice& lattice, const BrickCoord& coord);

}  // namespace sonoloft
