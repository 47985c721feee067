#pragma once
// News -> [SCENE] -> a message for each viewer
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "host/view/scene/bricks.h"
#include "host/view/scene/inbox.h"
#include "host/view/scene/probe_path.h"
#include "host/view/view_server.h"

namespace sonoloft::view {

/// What one viewer has seen: all that the server keeps of it.
struct Cursor {
  bool measured = false;     ///< it shows how sure the surface is
  bool coverage = false;     ///< it asks what was seen
  std::uint64_t bricks = 0;  ///< version
  std::uint64_t bricks_sent = 0;
  std::uint64_t stamp = 0;  ///< of everything else
  std::uint64_t slice = 0;
  ProbePath::Seen path;
};

/// What pages show now. Threads: the server's.
class Scene {
 public:
  explicit Scene(const ViewSource& source) : source_(source), bricks_(source.confidence) {}

  void take(const News& news);

  [[nodiscard]] bool has_news(const Cursor& cursor) const {
    return cursor.coverage || cursor.stamp != stamp_ || cursor.bricks != bricks_.version() ||
           (cursor.measured && bricks_.confidence_is_old());
  }

  /// What is new to a viewer; docs/viewer.md has the layout. A little above kSoftLimit bytes at most: what finds no
  /// room is in the next one.
  [[nodiscard]] std::string message(Cursor& cursor);
  static constexpr std::size_t kSoftLimit = std::size_t{4} << 20;

 private:
  [[nodiscard]] nlohmann::json status() const;
  nlohmann::json append_slice(Cursor& cursor, std::string& out) const;
  void renew_coverage();

  const ViewSource& source_;
  Bricks bricks_;
  ProbePath path_;
  std::uint64_t stamp_ = 0, slices_ = 0;
  std::shared_ptr<const MeshUpdate> mesh_;
  std::shared_ptr<const device::DeliveredSlice> slice_;
  ScanState state_;
  std::optional<ViewRecording> recording_;
  Coverage coverage_;
  std::shared_ptr<const MeshUpdate> covered_;           ///< the mesh that there was when it was asked for; null: never
  std::chrono::steady_clock::time_point coverage_due_;  ///< not asked for again before
  double latency_ms_ = 0;
  std::deque<std::chrono::steady_clock::time_point> arrivals_;  ///< of the last slices with a mesh
};

}  // namespace sonoloft::view
