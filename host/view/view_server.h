#pragma once
// scan -> MeshUpdate, DeliveredSlice -> [VIEW SERVER] -> pages in browsers
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/coverage/confidence.h"
#include "core/coverage/coverage.h"
#include "core/io/labels/label_table.h"
#include "core/slice/result.h"
#include "host/device/delivered_slice.h"
#include "host/device/ledger.h"
#include "host/scan/mesh_update.h"

namespace sonoloft::view {

inline constexpr std::uint16_t kDefaultPort = 8480;

struct ViewOptions {
  std::string address = "127.0.0.1";  ///< numeric, of this machine; pages need a token when it is no loopback address
  std::optional<std::uint16_t> port;  ///< 0: any free one; none: kDefaultPort, or any free one where that is taken
};

/// What a page shows besides the mesh, and what it may ask for. The functions are called on the server's thread; where
/// one is empty pages do not offer what it is for.
struct ViewSource {
  LabelTable labels;
  /// How sure points of the surface are, asked for while a page shows it as colour; see ScanSession::confidence().
  std::function<Confidence(std::span<const Eigen::Vector3f>)> confidence;
  /// What was seen and what was not, asked for while a page shows it; see ScanSession::coverage().
  std::function<Coverage()> coverage;
  std::function<device::Ledger()> ledger;
  std::function<void()> stop;  ///< the scan is to end; to be noted, not done, in the call
  /// The scan is to be recorded, or no longer; to be noted, not done, in the call.
  std::function<void(bool recording)> record;
};

/// How far the recording is that a page asked for, or what became of it.
struct ViewRecording {
  std::string file;  ///< its name
  bool running = false;
  double seconds = 0;
  std::uint64_t records = 0, not_recorded = 0;
  std::string failure;  ///< one line; empty: none
};

struct ViewFigures {
  std::size_t viewers = 0;        ///< now
  std::uint64_t bricks_sent = 0;  ///< to all of them, so far
  std::uint64_t messages_sent = 0, bytes_sent = 0;
  std::uint64_t refused = 0;  ///< requests for the scene from a foreign origin or without the token
};

/// Serves one page that shows a scan live, to any number of browsers (docs/viewer.md). Whoever shows it something hands
/// over a pointer and never waits for a viewer: each viewer asks for what is new to it when it is done with the last,
/// and gets the newest state of the bricks that changed since.
/// Threads: members may be called from any thread; the server has one of its own.
/// Frame: reference, mm.
class ViewServer {
 public:
  /// @error not_available: built without the page; invalid_argument (not an address); io_failed (the port is taken)
  [[nodiscard]] static Result<std::unique_ptr<ViewServer>> open(const ViewOptions& options, ViewSource source);
  /// Hangs up. @pre no other thread is in a call
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// The page, with the token where one is needed.
  [[nodiscard]] const std::string& url() const;

  /// The mesh from now on. @cost O(slices of the update)
  void show(std::shared_ptr<const MeshUpdate> update);
  /// The slice from now on, and a step of the probe's path. One without a sound pose is not shown.
  void show(std::shared_ptr<const device::DeliveredSlice> slice);
  /// What goes on, in a few words, e.g. "scanning".
  /// @param running  there is a scan to be stopped, or recorded
  void show(std::string state, bool running = false);
  /// The recording from now on.
  void show(ViewRecording recording);

  [[nodiscard]] ViewFigures figures() const;

 private:
  struct State;
  explicit ViewServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sonoloft::view
