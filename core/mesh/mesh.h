#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/octree/brick.h"
#include "core/slice/label.h"

namespace sonoloft {

/// One watertight surface network with shared vertices. Frame: reference, mm.
/// Every triangle separates two labels; its normal (counter-clockwise) points into the space of label_front.
struct IndexedMesh {
  std::vector<Eigen::Vector3f> positions;               ///< [#V] mm
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [#T]
  std::vector<Label> label_front;                       ///< [#T] the side the normal points to; 0 = outside
  std::vector<Label> label_back;                        ///< [#T] never equal to label_front
};

/// The triangles of one brick. Vertices on its border are repeated in the chunks beside it with the same bits.
struct MeshChunk {
  BrickCoord coord;
  std::vector<Eigen::Vector3f> positions;               ///< [#V] mm, reference frame
  std::vector<std::uint64_t> vertex_keys;               ///< [#V] the same vertex has the same key in every chunk
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< [#T] indices into this chunk's positions
  std::vector<Label> label_front;                       ///< [#T]
  std::vector<Label> label_back;                        ///< [#T]
};

/// An immutable mesh: keep it as long as you like, from any thread. Chunks that did not change are shared between
/// revisions.
struct MeshSnapshot {
  std::vector<std::shared_ptr<const MeshChunk>> chunks;  ///< ascending by coord, none empty

  /// Joins the chunks into one mesh. The order of vertices and triangles depends on the chunks alone.
  /// @cost O(#V + #T)
  [[nodiscard]] IndexedMesh indexed() const;
};

}  // namespace sonoloft
