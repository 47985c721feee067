#pragma once
// scan's threads -> [INBOX] -> server's thread
#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host/device/delivered_slice.h"
#include "host/scan/mesh_update.h"
#include "host/view/view_server.h"

namespace sonoloft::view {

struct ScanState {
  std::string words;
  bool running = false;  ///< there is a scan to be stopped, or recorded
};

/// What a scan handed over and the server has not looked at yet: the newest of each kind, so that it never grows beyond
/// a bound however long the server is busy.
struct News {
  std::shared_ptr<const MeshUpdate> mesh;
  std::shared_ptr<const device::DeliveredSlice> slice;
  std::vector<Eigen::Vector3f> path;  ///< [<= kMaxSteps] where the slices' images begin, mm, reference
  std::optional<ScanState> state;
  std::optional<ViewRecording> recording;

  static constexpr std::size_t kMaxSteps = 4096;  ///< more are not kept
};

/// Threads: any.
class Inbox {
 public:
  /// Each returns whether the inbox was empty, so that somebody has to be woken.
  [[nodiscard]] bool put(std::shared_ptr<const MeshUpdate> mesh);
  [[nodiscard]] bool put(std::shared_ptr<const device::DeliveredSlice> slice);
  [[nodiscard]] bool put(ScanState state);
  [[nodiscard]] bool put(ViewRecording recording);

  [[nodiscard]] News take();

 private:
  std::mutex mutex_;
  bool empty_ = true;
  News news_;
};

}  // namespace sonoloft::view
