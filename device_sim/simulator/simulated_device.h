#pragma once
// subject, plan -> [SIMULATED DEVICE: trajectory, probe, firmware, cable] -> port -> host
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "device_sim/port/loopback_device.h"
#include "device_sim/probe/simulated_probe.h"
#include "device_sim/simulator/memory_blobs.h"
#include "protocol/command.h"
#include "protocol/port.h"

namespace sonoloft::device_sim {

/// What a simulated probe scans.
struct Subject {
  std::shared_ptr<const SectionSource> source;
  std::optional<Trajectory> recorded;              ///< where its slices were taken; else it can be cut anywhere
  std::uint32_t max_points = 0, max_contours = 0;  ///< of a recorded slice
  std::vector<Label> bones{};  ///< labels that sound does not pass; with any, it is scanned as a patient is
};

struct ScanPlan {
  std::optional<std::uint32_t> slices;  ///< at least 1, of recorded ones at most as many as there are; none: 60, of a
                                        ///< subject with bones 300, or all that were recorded
  double rate_hz = 10;                  ///< 0: as fast as the host takes them
  bool masks = false;                   ///< it sends masks of 512 pixels, as a segmenting network gives them
  std::uint64_t seed = 1;               ///< of the hand's tremor and of all noise
};

/// A whole probe in this process, that a trembling hand moves over the subject, tilting it; recorded slices are sent as
/// they were taken. A subject that can be cut anywhere is seen through the sector of the image that just holds it. One
/// with bones is scanned as a patient is: in passes of parallel planes, through a sector that sees a part, with shadows
/// behind the bones, contact lost at the edges, noise of the tracker and of the contours.
/// Threads: one of its own; members from any thread.
class SimulatedDevice {
 public:
  /// @param on_slice  called with every slice that is sent, on the device's thread; may be empty
  /// @error no source, an option outside of its range
  [[nodiscard]] static Made<SimulatedDevice> make(const Subject& subject, const ScanPlan& plan,
                                                  std::function<void(const AcquiredSlice&)> on_slice = {});

  /// @pre whoever uses it is gone before the device is
  [[nodiscard]] protocol::Port& port() { return device_->port(); }
  /// A button of the probe is pressed or let go.
  void button(std::uint16_t number, bool pressed) { device_->button(number, pressed); }
  [[nodiscard]] std::size_t slices() const { return probe_->image_count(); }
  [[nodiscard]] const FirmwareConfig& firmware() const { return firmware_; }
  /// @pre nobody uses the port
  [[nodiscard]] const MemoryBlobs& blobs() const { return blobs_; }

 private:
  SimulatedDevice() = default;
  const AcquiredSlice* next();

  std::function<void(const AcquiredSlice&)> on_slice_;
  MemoryBlobs blobs_;
  FirmwareConfig firmware_;
  std::unique_ptr<SimulatedProbe> probe_;
  std::optional<SimulatedFrame> frame_;
  AcquiredSlice view_;
  std::optional<std::uint64_t> clock_offset_ns_;  ///< from the probe's image times to the device's clock
  std::unique_ptr<LoopbackDevice> device_;        ///< its thread uses the members above: it goes first
};

}  // namespace sonoloft::device_sim
