#pragma once
#include <Eigen/Core>
#include <array>
#include <cassert>
#include <cstdint>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"

namespace sonoloft {

/// Positions are fixed point: whole numbers of 1/65536 lattice steps. Whoever computes with them (envelopes, sides of
/// a triangle) is exact, and a vertex has the same bits in every chunk.
inline constexpr std::int32_t kStep = 1 << 16;

/// A position within a cell, 0..kStep from its lowest corner.
using CellPoint = std::array<std::uint16_t, 3>;
/// A position relative to the first sample of a brick, in 1/65536 lattice steps.
using BrickPoint = std::array<std::int32_t, 3>;

/// A cell or a lattice point relative to the first sample of a brick: -1..8 in each axis.
struct LocalPoint {
  int x, y, z;
};

/// The point with a sample_index.
inline LocalPoint local_point(int index) {
  return {index & 7, index >> 3 & 7, index >> 6};
}

/// Cell corners and the vectors between them are bit sets: bit 0 = x, bit 1 = y, bit 2 = z.
inline LocalPoint corner_of(LocalPoint cell, unsigned corner) {
  return {cell.x + static_cast<int>(corner & 1), cell.y + static_cast<int>(corner >> 1 & 1),
          cell.z + static_cast<int>(corner >> 2 & 1)};
}

/// A length of less than one lattice step.
inline std::uint16_t to_fixed(float steps) {
  return static_cast<std::uint16_t>(steps * static_cast<float>(kStep) + 0.5F);
}

inline BrickPoint operator+(LocalPoint cell, const CellPoint& p) {
  return {cell.x * kStep + p[0], cell.y * kStep + p[1], cell.z * kStep + p[2]};
}

/// What a vertex stands on: the cell at a lattice point (0), or a simplex that lies there (kSimplexNames).
constexpr unsigned kCellVertex = 0;
inline constexpr unsigned kSimplexKinds = 78;

/// The name of a vertex, the same in all chunks: 19 bits a lattice coordinate, 7 bits for the kind.
inline std::uint64_t vertex_key(const BrickCoord& brick, LocalPoint at, unsigned kind) {
  const auto biased = [](std::int32_t brick_coord, int local) {
    const std::int64_t value = std::int64_t{brick_coord} * kBrickSize + local + (1 << 18);
    assert(value >= 0 && value < 1 << 19);
    return static_cast<std::uint64_t>(value);
  };
  return biased(brick.x, at.x) << 45 | biased(brick.y, at.y) << 26 | biased(brick.z, at.z) << 7 | kind;
}

/// Where a lattice lies.
struct LatticeFrame {
  Eigen::Vector3d origin_mm;
  double spacing_mm;
};

/// The only place where a position becomes millimetres. The lattice coordinate is exact in a double whatever brick it
/// is told from, so the float is the same in every chunk.
inline Eigen::Vector3f to_mm(const LatticeFrame& frame, const BrickCoord& brick, const BrickPoint& p) {
  const auto coordinate = [](std::int32_t brick_coord, std::int32_t local) {
    return static_cast<double>(std::int64_t{brick_coord} * kBrickSize * kStep + local) / kStep;
  };
  const Eigen::Vector3d steps(coordinate(brick.x, p[0]), coordinate(brick.y, p[1]), coordinate(brick.z, p[2]));
  return (frame.origin_mm + frame.spacing_mm * steps).cast<float>();
}

}  // namespace sonoloft
