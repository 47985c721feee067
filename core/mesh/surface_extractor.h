#pragma once
// Stage 4 of 5:  cells -> field -> octree -> [MESH] -> callback
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/octree/brick.h"

namespace sonoloft {

/// Draws the surface network between the labels of a lattice, and redraws only what changed. Frame: reference, mm.
/// Surface nets where every label is simple in a cell, marching tetrahedra in the few other cells. For every label the
/// triangles that have it in front or behind form closed 2-manifolds that do not cross one another; the proof and its
/// two conditions (the postcondition of SampleLattice; float positions) are in docs/pipeline/6-mesh.md.
/// The mesh is a function of the samples alone: neither the order of updates nor the number of threads shows in a byte.
/// Threads: one writer; const members may run together, but not during update().
/// Source: Ju, Udeshi 2006 (envelopes), simplified for a uniform lattice; Gibson 1998 (surface nets).
class SurfaceExtractor {
 public:
  struct Counters {
    std::size_t bricks_read = 0;          ///< by the last update(): bricks whose samples were looked at
    std::size_t leaves = 0;               ///< of the whole mesh: finest cells with more than one label
    std::size_t complex_cells = 0;        ///< of those, cells drawn by marching tetrahedra
    std::size_t fans = 0;                 ///< of the whole mesh: quads drawn as a fan of four, no diagonal being safe
    std::size_t collapsed_triangles = 0;  ///< of the whole mesh: two corners with the same float position. Not 0 means
                                          ///< that the lattice is too far from 0 mm for its spacing: move the frame
  };

  SurfaceExtractor();
  ~SurfaceExtractor();
  SurfaceExtractor(SurfaceExtractor&&) noexcept;
  SurfaceExtractor& operator=(SurfaceExtractor&&) noexcept;

  /// Brings the mesh up to date.
  /// @param changed  bricks with a cell of which a corner's sample or a contour changed, appeared or vanished since the
  ///                 last update(), in any order; the first update() names all bricks
  /// @return chunks whose content changed, appeared or vanished, ascending
  /// @pre  the lattice obeys the postcondition of SampleLattice, has the same origin and spacing in every call, and
  ///       lattice coordinates within -2^18 .. 2^18 - 1; threads >= 1
  /// @post snapshot() is what a new extractor would make of the whole lattice, byte for byte
  /// @cost O(samples of `changed`, triangles of these bricks and of those beside them)
  std::vector<BrickCoord> update(const SampleLattice& lattice, std::span<const BrickCoord> changed, int threads);

  /// The mesh now. Chunks are shared with earlier snapshots where they did not change.
  /// @cost O(chunks), no triangle is copied
  [[nodiscard]] MeshSnapshot snapshot() const;

  [[nodiscard]] std::size_t chunks_rebuilt() const;  ///< by the last update()
  /// @cost O(chunks)
  [[nodiscard]] Counters counters() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft
