#pragma once
// MeshUpdate -> [BRICKS] -> what changed since a viewer looked last
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/coverage/confidence.h"
#include "core/mesh/mesh.h"
#include "core/octree/brick.h"
#include "host/view/scene/brick_bytes.h"

namespace sonoloft::view {

/// The chunks of the newest mesh, each with the version at which it looked different last. A viewer is a number: the
/// newest version it has; whatever is above it is what it lacks, so nothing is queued for anybody.
/// Threads: the server's.
class Bricks {
 public:
  using AskConfidence = std::function<Confidence(std::span<const Eigen::Vector3f>)>;

  /// @param confidence  may be empty
  explicit Bricks(AskConfidence confidence) : confidence_(std::move(confidence)) {}

  /// The mesh from now on. Chunks that are the same object as before did not change; those beside one that did look
  /// different at their border. @cost O(chunks), 27 look-ups a changed one
  void take(MeshSnapshot mesh);

  /// Appends bricks with a version above `seen`, oldest first, until `out` holds more than `soft_limit` bytes.
  /// @param measured  with the confidence of the vertices, asked for once; as many bricks as that question is about
  /// @return how many
  std::size_t append_newer(std::uint64_t& seen, bool measured, std::size_t soft_limit, std::string& out);

  /// Confidence grows with every slice, also where the mesh stays: lets up to `count` bricks, those first whose
  /// confidence is oldest, count as changed.
  void renew_confidence(std::size_t count);
  /// There are bricks whose confidence is that of an earlier mesh.
  [[nodiscard]] bool confidence_is_old() const { return oldest() != by_version_.end(); }

  [[nodiscard]] std::uint64_t version() const { return version_; }
  [[nodiscard]] std::size_t count() const { return mesh_.chunks.size(); }
  [[nodiscard]] std::size_t triangles() const { return triangles_; }
  [[nodiscard]] std::size_t faces() const { return faces_; }  ///< triangles as sent: one between two materials twice

 private:
  struct Brick {
    std::shared_ptr<const MeshChunk> chunk;  ///< null: it vanished
    std::uint64_t version = 0;
    std::string bytes;              ///< as sent; empty until asked for
    std::uint64_t measured_at = 0;  ///< the mesh whose confidence is in the bytes; 0: none
    [[nodiscard]] bool lacks_confidence() const { return chunk && (bytes.empty() || measured_at == 0); }
  };
  using ByVersion = std::map<std::uint64_t, BrickCoord>;
  [[nodiscard]] ByVersion::const_iterator oldest() const;
  void change(const BrickCoord& coord, std::shared_ptr<const MeshChunk> chunk);
  void touch(const BrickCoord& coord, Brick& brick);
  void ask_confidence(std::uint64_t seen);
  void encode(const BrickCoord& coord, Brick& brick, const Confidence& sure);
  [[nodiscard]] Neighbours around(const BrickCoord& coord) const;

  AskConfidence confidence_;
  MeshSnapshot mesh_;
  std::uint64_t meshes_ = 0, version_ = 0;
  std::size_t triangles_ = 0, faces_ = 0;
  std::unordered_map<BrickCoord, Brick, BrickCoordHash> bricks_;
  ByVersion by_version_;  ///< of every brick

  /// Vertices that one question is about, but for the last brick's: the scan waits some 50 ms.
  static constexpr std::size_t kPointsAsked = 20000;
};

}  // namespace sonoloft::view
