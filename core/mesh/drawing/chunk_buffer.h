#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/mesh/lattice_position.h"

namespace sonoloft {

/// The triangles of one chunk while they are drawn. Used again for chunk after chunk, so that memory is asked for once.
class ChunkBuffer {
 public:
  void start(const BrickCoord& coord);

  /// A cell, -1..8 in each axis, as a number, and from it to the next in each axis.
  static constexpr std::array<int, 3> kPlaces = {1, kBrickSize + 2, (kBrickSize + 2) * (kBrickSize + 2)};
  static constexpr int place(LocalPoint cell) {
    return (cell.x + 1) * kPlaces[0] + (cell.y + 1) * kPlaces[1] + (cell.z + 1) * kPlaces[2];
  }

  /// The index of the vertex of the cell at a place.
  std::uint32_t cell_vertex(int place, const CellPoint& point) {
    const std::uint16_t slot = cell_slots_[static_cast<std::size_t>(place)];
    return slot != 0 ? slot - 1u : add_cell_vertex(place, point);
  }

  /// The index of the node of a simplex, whose lowest corner is 0..8 in each axis; `position` is called on first use.
  template <class Position>
  std::uint32_t node(LocalPoint base, unsigned kind, const Position& position) {
    if (node_slots_.empty()) node_slots_.assign(kNodeSlots, 0);
    const auto at =
        (static_cast<std::size_t>(base.x + kNodeSide * (base.y + kNodeSide * base.z))) * kSimplexKinds + kind;
    if (node_slots_[at] == 0) {
      node_slots_[at] = add_vertex(base, kind, position()) + 1;
      used_nodes_.push_back(at);
    }
    return node_slots_[at] - 1;
  }

  [[nodiscard]] const BrickPoint& position(std::uint32_t vertex) const { return points_[vertex]; }

  /// Adds a triangle whose normal points into label `ahead`; turns it so that the smaller label is in front.
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Label ahead, Label behind) {
    chunk_.triangles.push_back(ahead < behind ? std::array{a, b, c} : std::array{a, c, b});
    chunk_.label_front.push_back(std::min(ahead, behind));
    chunk_.label_back.push_back(std::max(ahead, behind));
  }

  /// The chunk, null when it has no triangle; `previous` itself when it has the same content.
  [[nodiscard]] std::shared_ptr<const MeshChunk> finish(const LatticeFrame& frame,
                                                        const std::shared_ptr<const MeshChunk>& previous);

  /// Triangles of which two corners became the same position in floats. @pre finish() was called
  [[nodiscard]] std::uint32_t collapsed_triangles() const;

 private:
  static constexpr int kNodeSide = kBrickSize + 1;
  static constexpr std::size_t kNodeSlots = std::size_t{kNodeSide} * kNodeSide * kNodeSide * kSimplexKinds;

  std::uint32_t add_cell_vertex(int place, const CellPoint& point);
  std::uint32_t add_vertex(LocalPoint at, unsigned kind, const BrickPoint& point);

  MeshChunk chunk_;
  std::vector<BrickPoint> points_;                                 ///< [#V]
  std::array<std::uint16_t, kPlaces[1] * kPlaces[2]> cell_slots_;  ///< index + 1, or 0
  std::vector<std::uint32_t> node_slots_;                          ///< index + 1, or 0; [0] until needed
  std::vector<std::size_t> used_nodes_;                            ///< slots to clear
};

}  // namespace sonoloft
