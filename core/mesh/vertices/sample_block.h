#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/lattice_position.h"

namespace sonoloft {

/// What a cell is decided from: the labels of its 8 corners, the shares of those labels in all corners, and how far
/// these are from the nearest slice.
struct CellSamples {
  int label_count;                            ///< 1..8
  std::array<Label, 8> label;                 ///< [label_count] ascending
  std::array<std::uint8_t, 8> corners;        ///< [label_count] bit set of the corners with that label
  std::array<std::uint8_t, 8> owner;          ///< [8] index into label of each corner
  std::array<std::array<float, 8>, 8> share;  ///< [label_count][8]
  std::array<float, 8> slice_steps;           ///< see Brick

  /// Fills everything but the shares and the distances.
  void sort_labels(const std::array<Label, 8>& corner_labels);
};

/// The samples of a brick and of the first layers of the bricks above it, 0..8 in each axis: all corners of its cells.
/// Flat arrays, gathered once; x runs fastest.
class SampleBlock {
 public:
  static constexpr int kSide = kBrickSize + 1;
  static constexpr int kLayer = kSide * kSide;
  static constexpr int kPoints = kSide * kLayer;
  static constexpr int index(int x, int y, int z) { return x + kSide * y + kLayer * z; }
  /// From a cell's lowest corner to its corner c.
  static constexpr std::array<int, 8> kCorner = {0,      1,          kSide,          kSide + 1,  // index() of (0..1)^3
                                                 kLayer, kLayer + 1, kLayer + kSide, kLayer + kSide + 1};

  /// Reads the labels of a brick; the shares of a label are read when they are asked for.
  void select(const SampleLattice& lattice, const BrickCoord& coord);

  /// All labels; kNotSampled where there is no brick.
  [[nodiscard]] const std::array<Label, kPoints>& labels() const { return labels_; }

  /// The labels of a cell of the brick, 0..7 in each axis, and then the shares and the distances from slices.
  void cell_labels(LocalPoint cell, CellSamples& samples) const;
  void cell_shares(LocalPoint cell, CellSamples& samples);

 private:
  const float* plane_of(Label label);
  void read_plane(Label label, float* plane) const;

  std::array<const Brick*, 8> bricks_{};
  std::array<Label, kPoints> labels_{};
  std::array<float, kPoints> slice_steps_{};
  std::vector<Label> planes_of_;  ///< [#planes] labels whose shares were read so far
  std::vector<float> planes_;     ///< [>= #planes][kPoints] shares; 0 where the label does not occur
};

}  // namespace sonoloft
