#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "core/slice/result.h"
#include "host/device/calibration.h"
#include "host/device/delivered_slice.h"
#include "host/device/statistics.h"
#include "host/device/transport.h"
#include "protocol/command.h"

// device -> transport -> [SESSION] -> slices -> reconstruction

namespace sonoloft::device {

using protocol::BlobKind;
using protocol::StreamMode;

class Requester;
class Run;

/// What a device says of itself.
struct DeviceInfo {
  protocol::Version version;  ///< the one spoken: the lower minor of both ends
  std::string firmware_version;
  std::string serial;
  std::uint32_t capabilities = 0;  ///< protocol::kCap...
  std::uint32_t schema_hash = 0;
  std::size_t max_record = 0;  ///< bytes
  std::uint32_t max_points = 0;
  std::uint32_t max_contours = 0;
  Label max_label = 0;
  std::uint16_t ring_capacity = 0;  ///< records
  std::uint32_t max_mask_runs = 0;  ///< 0: it sends no masks
  std::uint32_t max_mask_pixels = 0;
  std::size_t max_blob = 0;   ///< bytes; 0: it takes no blobs
  std::size_t max_block = 0;  ///< bytes
};

struct StreamOptions {
  /// live: what is not taken in time is dropped, oldest first, here and in the device, and counted.
  /// lossless: a slow callback holds the link back instead, and a device that cannot wait reports a fault.
  StreamMode mode = StreamMode::live;
  std::size_t queue_capacity = 64;  ///< slices that may wait for the callback, at least 1
};

/// An opened device. Runs it between start() and stop(), turns its records into slices in mm, and keeps the books.
///
/// Threads. Members may be called from any thread and from callbacks. A run has a dispatcher, the only thread that
/// calls back, and a keeper, which sends a sign of life every 250 ms and takes the run down; docs/threads.md has all of
/// it.
class Session {
 public:
  /// Stops whatever an earlier session left running, agrees on the version and fetches the calibration.
  /// @error protocol_mismatch ("have X, need Y"), not_rigid (the calibration is no rotation with pixel sizes),
  ///        not_available (no calibration), transport_closed, timed_out, refused_by_device
  [[nodiscard]] static Result<std::unique_ptr<Session>> open(std::unique_ptr<Transport> transport);

  /// Stops. @pre not called on a callback's thread
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const DeviceInfo& info() const { return info_; }
  [[nodiscard]] const Calibration& calibration() const { return calibration_; }

  /// Starts a run under a new session id. Slices begin to arrive before it returns. A device that went away since the
  /// last run is looked for, one that stood still is reset, and the session goes on with it when it is the same.
  /// @error wrong_state (running, or called from a callback), invalid_argument (empty queue),
  ///        protocol_mismatch (the device has no such mode, or says something else of itself than at open()),
  ///        device_not_found (it is not back yet), and those of open()
  [[nodiscard]] Result<void> start(const StreamOptions& options, Callbacks callbacks);

  /// Ends the run; slices that still wait are dropped and counted. Legal at any time.
  /// From a callback: marks and returns at once; after that callback has returned no other runs.
  /// From elsewhere: returns after the last callback has returned and the books are closed.
  void stop();

  /// Sends a blob (a firmware image, what the maker measured) to the device, which keeps it. What a device makes of a
  /// new firmware is its own affair: it may leave and come back, and then is opened anew.
  /// @error wrong_state (a run goes on, or called from a callback), not_available (it takes none, or the bus cannot),
  ///        invalid_argument (nothing, or more than max_blob), refused_by_device (not what it takes), io_failed,
  ///        timed_out, transport_closed
  /// @cost  blocks until the device has kept it: seconds
  [[nodiscard]] Result<void> send_blob(BlobKind kind, std::span<const std::byte> bytes);

  /// The figures of the present run, or of the last one. Its books are closed only after stop() returned outside of
  /// callbacks.
  [[nodiscard]] Statistics statistics() const;
  [[nodiscard]] Ledger ledger() const { return statistics().ledger; }

 private:
  /// What a device says when it is opened.
  struct Greeting {
    protocol::InfoReply info;
    protocol::CalibrationMessage calibration;
  };

  Session(std::unique_ptr<Transport> transport, std::unique_ptr<Requester> requester, const Greeting& greeting,
          DeviceInfo info, Calibration calibration);
  static Result<Greeting> greet(Requester& requester);
  Result<void> make_way();  ///< with life_mutex_ held: no run, and the device is there
  Result<void> find_again();
  [[nodiscard]] std::shared_ptr<Run> run() const;
  [[nodiscard]] bool on_dispatcher() const;
  void finish_run();  ///< with life_mutex_ held

  std::unique_ptr<Transport> transport_;
  std::unique_ptr<Requester> requester_;
  const Greeting greeting_;
  DeviceInfo info_;
  Calibration calibration_;
  bool lost_ = false;               ///< in the last run; with life_mutex_ held
  std::mutex life_mutex_;           ///< one start or stop at a time; never taken on a callback's thread
  mutable std::mutex state_mutex_;  ///< guards run_ and last_; held for moments only
  std::shared_ptr<Run> run_;
  Statistics last_;
};

}  // namespace sonoloft::device
