#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "device_sim/firmware/firmware.h"
#include "device_sim/port/cable.h"

// source -> [LOOPBACK DEVICE: acquisition thread, firmware, cable] -> host

namespace sonoloft::device_sim {

/// The next slice, or nullptr at the end. Its views stay valid until the next call. Called on the acquisition thread.
using SliceSource = std::function<const AcquiredSlice*()>;

struct LoopbackOptions {
  FirmwareConfig firmware;
  std::size_t ring_records = 16;  ///< at least 1
  std::optional<double> rate_hz;  ///< positive; empty: as fast as the stream takes them
};

/// A whole device in this process: slices of a source go through the firmware to whoever holds its port. The source is
/// asked only while the device streams, so its first slice is the first record. Paced, the acquisition waits for
/// nobody, as a probe does; unpaced, a lossless stream makes it wait instead of failing. Threads: one of its own;
/// members from any thread.
class LoopbackDevice {
 public:
  LoopbackDevice(const LoopbackOptions& options, SliceSource source);
  /// @pre nobody uses port() any more
  ~LoopbackDevice();
  LoopbackDevice(const LoopbackDevice&) = delete;
  LoopbackDevice& operator=(const LoopbackDevice&) = delete;

  [[nodiscard]] protocol::Port& port() { return cable_; }
  /// The cable is pulled, for good.
  void unplug() { cable_.unplug(); }
  /// A button of the probe is pressed or let go.
  void button(std::uint16_t number, bool pressed) { cable_.button(number, pressed); }
  /// What GET_STATS would say, without being a sign of life.
  [[nodiscard]] protocol::StatsReply stats() { return cable_.stats(); }

 private:
  struct alignas(protocol::kRecordAlign) Block {
    std::byte bytes[protocol::kRecordAlign];
  };

  void acquire_all(const SliceSource& source, std::optional<double> rate_hz);

  std::vector<Block> memory_;
  Firmware firmware_;
  Cable cable_;
  std::jthread acquisition_;
};

}  // namespace sonoloft::device_sim
