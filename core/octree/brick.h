#pragma once
// Stage 3 of 5:  cells -> field -> [OCTREE] -> mesh -> callback
#include <Eigen/Core>
#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/cells/cell_complex.h"
#include "core/slice/label.h"

namespace sonoloft {

/// Samples sit on the lattice  origin + spacing * (i, j, k); a brick owns 8 x 8 x 8 of them, those of
/// 8 * coord + (0..7, 0..7, 0..7). The finest cell of a sample is the cube between it and its upper neighbours.
inline constexpr int kBrickSize = 8;
inline constexpr int kBrickSamples = kBrickSize * kBrickSize * kBrickSize;
/// The label of a lattice point that was not sampled (far from every surface).
inline constexpr Label kNotSampled = 0xFFFE;
/// Lattice steps from the nearest slice beyond which nothing depends on them.
inline constexpr float kFarFromSlices = 2;

struct BrickCoord {
  std::int32_t x, y, z;
  friend auto operator<=>(const BrickCoord&, const BrickCoord&) = default;
};

struct BrickCoordHash {
  std::size_t operator()(const BrickCoord& c) const {
    const auto u = [](std::int32_t v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
    std::uint64_t h = u(c.x) * 0x9E3779B97F4A7C15ull ^ u(c.y) * 0xC2B2AE3D27D4EB4Full ^ u(c.z) * 0x165667B19E3779F9ull;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};

/// Index of sample (x, y, z), each 0..7, within its brick.
constexpr int sample_index(int x, int y, int z) {
  return x + kBrickSize * (y + kBrickSize * z);
}

/// The finished (smoothed) samples of one brick: what the mesh is drawn from.
struct Brick {
  BrickCoord coord;
  std::array<Label, kBrickSamples> label;  ///< label with the largest share, lowest of equals; kNotSampled
  std::vector<Label> palette;              ///< [#P] ascending: labels that occur with a share in this brick
  std::vector<float> share;                ///< [#P][kBrickSamples] share of a label, 0..1 up to rounding; labels not in
                                           ///< the palette have share 0; meaningless where label is kNotSampled
  std::vector<float> unmeasured;   ///< [kBrickSamples] share of a sample, before smoothing, that no slice gave but
                                   ///< the background; empty: slices gave all
  std::vector<float> slice_steps;  ///< [kBrickSamples] lattice steps from the nearest slice that bounds the sample's
                                   ///< convex cell, at most kFarFromSlices; empty: all of them that
};

/// A piece of the contours of the slices within the cells of one brick: a straight border between two labels.
struct ContourPiece {
  Eigen::Vector3f a, b;     ///< lattice steps from the brick's first sample, 0..8
  Label lower, upper;       ///< the labels beside it, lower < upper
  SliceId slice;            ///< that shows it
  bool a_is_end, b_is_end;  ///< not only of this piece, but of an edge of the contour
};

/// What the mesh stage reads. Postcondition of every update, on which closed meshes rest: for every lattice edge whose
/// two ends are sampled and differ in label, all four finest cells around that edge have all of their 8 corners
/// sampled. Threads: const members may run together, but not during an update.
class SampleLattice {
 public:
  virtual ~SampleLattice() = default;
  /// The brick, or null when none of its samples was taken. Valid until the next update. O(1)
  [[nodiscard]] virtual const Brick* find(BrickCoord coord) const = 0;
  /// The contours in the cells of a brick, ascending by slice. Valid until the next update. O(1)
  [[nodiscard]] virtual std::span<const ContourPiece> contours(BrickCoord coord) const = 0;
  [[nodiscard]] virtual Eigen::Vector3d origin_mm() const = 0;  ///< lattice point (0,0,0), reference frame
  [[nodiscard]] virtual double spacing_mm() const = 0;
};

}  // namespace sonoloft
