#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/field/packing/packed_cells.h"
#include "core/octree/unmeasured_fill.h"
#include "core/slopes/contour_slopes.h"

namespace sonoloft {

/// The convex cells that samples were found in: packed for the field, each with what its samples want to know of it
/// besides. Threads: const members may run together.
class SampledCells {
 public:
  /// A slice beside which samples are pinned: normal . x + offset = signed distance, mm.
  struct PinPlane {
    Eigen::Vector3d normal;
    double offset_mm;
  };

  /// @param slopes  how contours move, or null: they do not
  /// All of them live as long as this.
  SampledCells(const CellComplex& cells, const ContourSlopes* slopes, const UnmeasuredFill& fill);

  /// The index that a cell has, or gets by the next pack().
  [[nodiscard]] std::uint32_t find_or_add(CellId cell);
  /// Appends the cells that were added since to `packed`, which has those before. @cost that of PackedCells::add()
  void pack(PackedCells& packed, int threads);

  // Of a packed cell:
  [[nodiscard]] CellId cell(std::uint32_t index) const { return known_[index].cell; }
  [[nodiscard]] std::span<const PinPlane> pins(std::uint32_t index) const { return known_[index].pins; }
  /// Those of its last slots.
  [[nodiscard]] std::span<const Rim* const> rims(std::uint32_t index) const { return known_[index].rims; }

 private:
  static constexpr std::uint32_t kNotKnown = 0xFFFFFFFF;
  struct Known {
    CellId cell;
    std::vector<PinPlane> pins;
    std::vector<const Rim*> rims;
  };
  /// Room to work in for one cell.
  struct Scratch {
    std::vector<CellFace> faces;
    std::vector<std::uint32_t> apart;
    std::vector<FaceBends> bends;
  };
  void pack(Known& known, Scratch& scratch, PackedCells& out) const;
  [[nodiscard]] const Rim* rim_at(const CellFace& face, const Eigen::AlignedBox3d& cell) const;

  const CellComplex& cells_;
  const ContourSlopes* slopes_;
  const UnmeasuredFill& fill_;
  std::vector<Known> known_;
  std::vector<std::uint32_t> index_;  ///< [cell] in known_, kNotKnown
};

}  // namespace sonoloft
