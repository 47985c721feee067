#pragma once
// device -> slices -> reconstruction -> [SCAN SESSION] -> your callback
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/reconstructor/reconstructor.h"
#include "core/slice/result.h"
#include "host/device/session.h"
#include "host/device/transport.h"
#include "host/scan/mesh_update.h"
#include "host/scan/scan_event.h"

namespace sonoloft {

struct ScanOptions {
  ReconstructorOptions reconstructor;
  /// Its mode is also that of the scan's own queue. live: slices that come faster than they are used give way, oldest
  /// first, and are counted. lossless: they hold the link back.
  device::StreamOptions stream;
  std::size_t queue_capacity = 256;  ///< slices that may wait for the reconstruction, at least 1
  /// Poses are interpolated: an image gets the one of its time + this offset, which `sonoloft calibrate-time` measures.
  /// Slices then come one tracker period later. Empty: an image keeps the pose that came with it.
  std::optional<std::chrono::nanoseconds> pose_offset;
};

/// What a scan calls: always on the scan's reconstruction thread, one call at a time, with no lock held. Every member
/// of ScanSession may be called from them. Each may be empty.
struct ScanCallbacks {
  /// An exception that leaves it becomes a callback_threw event. While it runs slices wait, the link does not.
  std::function<void(std::shared_ptr<const MeshUpdate>)> on_mesh;
  std::function<void(const ScanEvent&)> on_event;  ///< comes after the mesh of all slices that were there before it
  /// Every slice that is taken out of the queue, once, in order, with the pose it is used with, before the mesh that
  /// has it is made; also those that will be refused: look at pose_status. Its time is part of the slices' latency. An
  /// exception that leaves it becomes a callback_threw event. Slices that are dropped do not come by; when the scan is
  /// stopped before their mesh is made, those that did count as dropped, too.
  std::function<void(std::shared_ptr<const device::DeliveredSlice>)> on_slice = {};
};

/// A device and a reconstruction, joined: slices of the device go into the mesh as they come, and every new mesh goes
/// to your callback. Slices whose pose is not ok are refused, not inserted. The first run starts with an empty space;
/// later runs of the same session go on with what is there.
///
/// Threads. Members may be called from any thread and from callbacks. Slices arrive on the device's dispatcher; the
/// reconstruction thread takes all that wait, calls on_slice for each, adds them, updates the mesh once and calls
/// on_mesh.
class ScanSession {
 public:
  /// Opens the device and prepares the reconstruction, which the first time may take a second.
  /// @error those of device::Session::open() and Reconstructor::create(); invalid_argument (a queue of 0 slices)
  [[nodiscard]] static Result<std::unique_ptr<ScanSession>> open(std::unique_ptr<device::Transport> transport,
                                                                 const ScanOptions& options);

  /// Stops. From a callback: returns at once, and that callback is the last; the transport is closed on the
  /// reconstruction thread soon after it returned. From elsewhere: everything is down on return.
  /// @pre no other thread is in a call, but for a start() whose first callback this is
  ~ScanSession();
  ScanSession(const ScanSession&) = delete;
  ScanSession& operator=(const ScanSession&) = delete;

  /// Starts a run. Meshes may arrive before it returns.
  /// @error wrong_state (running, or called from a callback), and those of device::Session::start()
  [[nodiscard]] Result<void> start(ScanCallbacks callbacks);

  /// Ends the run; slices that still wait are dropped and counted. Legal at any time.
  /// From a callback: marks and returns at once; after that callback has returned no other runs.
  /// From elsewhere: returns after the last callback has returned and the books are closed.
  void stop();

  /// See device::Session::send_blob(). @error also wrong_state: called from a callback
  [[nodiscard]] Result<void> send_blob(device::BlobKind kind, std::span<const std::byte> bytes);

  /// Takes back a slice that the reconstruction has taken in, by DeliveredSlice::slice.id: a segmentation was
  /// corrected, a pose was wrong. While a run goes on a mesh without it follows at once, else with the next run.
  /// @error invalid_argument: no such slice is held. Waits for an update that runs.
  [[nodiscard]] Result<void> withdraw(std::uint64_t slice_id);
  /// What was seen so far and what was not, and which plane would show most of the rest. Waits for an update that runs;
  /// some 50 ms.
  [[nodiscard]] Coverage coverage() const;
  /// How sure vertices of the last mesh are. Called in on_mesh, "the last mesh" is that of the update at hand;
  /// elsewhere a newer one may have come. Waits for an update that runs.
  [[nodiscard]] Confidence confidence(std::span<const Eigen::Vector3f> points_mm) const;

  /// Books of the present run of the device, or of the last one; closed after stop() returned outside of callbacks.
  [[nodiscard]] device::Ledger ledger() const;
  [[nodiscard]] SliceCounts counts() const;
  [[nodiscard]] const device::DeviceInfo& device_info() const;
  /// Where the field is evaluated, e.g. "OpenCL: ..." or "CPU, AVX2".
  [[nodiscard]] const std::string& field_device() const;

 private:
  struct State;
  explicit ScanSession(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace sonoloft
