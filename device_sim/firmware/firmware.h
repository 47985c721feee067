#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "device_sim/firmware/acquired_slice.h"
#include "device_sim/firmware/blob_receiver.h"
#include "device_sim/firmware/event_queue.h"
#include "device_sim/firmware/record_ring.h"
#include "protocol/command.h"
#include "protocol/slice_codec.h"

// probe -> acquired slice -> [FIRMWARE] -> records -> bus;  bus -> requests -> [FIRMWARE] -> replies -> bus

namespace sonoloft::device_sim {

struct FirmwareConfig {
  protocol::SliceLimits limits{1u << 14, 512, 255, 1u << 15, 1u << 21};
  std::array<char, 40> serial{"SIM-0001"};     ///< zero-terminated
  protocol::CalibrationMessage calibration{};  ///< what the factory stored; id 0: none until SET_CALIBRATION
  BlobStore* blobs = nullptr;                  ///< outlives the firmware; nullptr: it takes none
};

inline constexpr std::int64_t kWatchdogMs = 1500;  ///< unless SET_PARAM says otherwise

/// The bytes one ring slot needs for slices within these limits (a field of view of up to max_points too).
[[nodiscard]] std::size_t record_slot_len(const protocol::SliceLimits& limits);

/// What a microcontroller runs: requests in, records out. No heap, no exceptions, no clock of its own: `now_ns` is the
/// device's monotone clock. Acquisition never waits: see protocol::StreamMode for what a full ring does.
/// Threads: one at a time (on a microcontroller: interrupts off).
class Firmware {
 public:
  /// @pre ring_memory.data() is 64-byte aligned, ring_memory.size() >= record_slot_len(config.limits);
  ///      both outlive the firmware. The ring has as many slots as fit.
  Firmware(const FirmwareConfig& config, std::span<std::byte> ring_memory);

  /// Answers one request. Any bytes are legal.
  /// @pre    reply.size() >= protocol::kMaxRequestLen
  /// @return the reply's length, at least 8
  [[nodiscard]] std::size_t handle_request(std::span<const std::byte> request, std::span<std::byte> reply,
                                           std::uint64_t now_ns);

  /// Takes one slice while streaming; drops it otherwise. A slice that breaks a rule is refused and counted.
  /// @cost O(#V + #C + #F), copies the slice into the ring
  void acquire(const AcquiredSlice& slice, std::uint64_t now_ns);

  /// Tells that the source has nothing more in this session; once is enough.
  void end_of_source(std::uint64_t now_ns);

  /// A button of the probe was pressed or let go; the host hears of it while a session runs.
  void button(std::uint16_t number, bool pressed, std::uint64_t now_ns);

  /// Moves the oldest record into `out`, its header complete and summed.
  /// @pre    out.size() >= max_record()
  /// @return the record's length, 0 when there is none
  [[nodiscard]] std::size_t take_record(std::span<std::byte> out);

  /// Writes the oldest event that waits, one that came in this session.
  /// @pre    out.size() >= protocol::kEventLen
  /// @return its length, 0 when there is none
  [[nodiscard]] std::size_t take_event(std::span<std::byte> out) { return events_.take(out); }

  /// One block of a blob, any bytes. @cost O(bytes), and what the store takes
  void take_block(std::span<const std::byte> block) { blobs_.take(block); }

  /// Looks at the clock: without a request for the watchdog's time the device stops by itself. Call at least every
  /// 100 ms; acquire() does it too.
  void tick(std::uint64_t now_ns);

  [[nodiscard]] protocol::DeviceState state() const { return state_; }
  [[nodiscard]] protocol::StreamMode mode() const { return mode_; }
  [[nodiscard]] bool ring_full() const { return ring_.full(); }
  [[nodiscard]] bool ring_empty() const { return ring_.empty(); }
  [[nodiscard]] bool events_empty() const { return events_.empty(); }
  [[nodiscard]] std::size_t max_record() const { return ring_.slot_len(); }
  [[nodiscard]] protocol::StatsReply stats() const;

 private:
  struct Answer {
    protocol::Status status;
    std::span<const std::byte> payload = {};
  };
  Answer answer(const protocol::RequestView& request, std::uint64_t now_ns);
  Answer start(std::span<const std::byte> payload);
  Answer param(std::span<const std::byte> payload, bool set);
  Answer set_calibration(std::span<const std::byte> payload);
  Answer begin_blob(std::span<const std::byte> payload);
  Answer keep_blob();
  Answer time_sync(std::span<const std::byte> payload, std::uint64_t now_ns);
  template <class T>
  Answer reply_with(const T& payload);
  void stop();
  void reset();
  void fault(protocol::DeviceFault fault, std::uint64_t now_ns);
  void tell(protocol::EventKind kind, std::uint64_t now_ns, std::uint16_t number = 0, std::uint32_t value = 0);
  protocol::InfoReply info() const;
  protocol::HeartbeatReply heartbeat() const;

  FirmwareConfig config_;
  RecordRing ring_;
  EventQueue events_;
  BlobReceiver blobs_;
  protocol::DeviceState state_ = protocol::DeviceState::idle;
  protocol::DeviceFault fault_ = protocol::DeviceFault::none;
  protocol::StreamMode mode_ = protocol::StreamMode::live;
  bool source_ended_ = false;
  std::uint8_t minor_ = protocol::kVersion.minor;
  std::uint32_t session_id_ = 0;
  std::uint64_t next_seq_ = 0, sent_ = 0, dropped_ = 0;
  std::uint32_t refused_ = 0;
  std::uint64_t last_request_ns_ = 0;
  std::int64_t watchdog_ms_ = kWatchdogMs;
  std::array<std::byte, sizeof(protocol::InfoReply)> answer_payload_{};  ///< the largest reply's payload
};

}  // namespace sonoloft::device_sim
