#pragma once
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/octree/brick.h"
#include "core/slice/section.h"

namespace sonoloft {

/// Samples that were taken once: bricks, and the contours in their cells.
class BrickLattice final : public SampleLattice {
 public:
  BrickLattice(const Eigen::Vector3d& origin_mm, double spacing_mm) : origin_mm_(origin_mm), spacing_mm_(spacing_mm) {}

  void add(std::unique_ptr<Brick> brick);
  /// The borders between the labels of a section, of which image_to_reference leads to the lattice's frame. Call it in
  /// the order of slices, when all bricks are there: contours where none is are left out.
  void add_contours(const Section& section, SliceId slice);

  [[nodiscard]] const Brick* find(BrickCoord coord) const override;
  [[nodiscard]] std::span<const ContourPiece> contours(BrickCoord coord) const override;
  [[nodiscard]] Eigen::Vector3d origin_mm() const override { return origin_mm_; }
  [[nodiscard]] double spacing_mm() const override { return spacing_mm_; }
  /// Ascending.
  [[nodiscard]] std::vector<BrickCoord> bricks() const;

 private:
  struct Place {
    std::unique_ptr<Brick> brick;
    std::vector<ContourPiece> contours;
  };
  Eigen::Vector3d origin_mm_;
  double spacing_mm_;
  std::unordered_map<BrickCoord, Place, BrickCoordHash> places_;
};

}  // namespace sonoloft
