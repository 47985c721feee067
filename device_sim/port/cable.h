#pragma once
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>

#include "device_sim/firmware/firmware.h"
#include "protocol/port.h"

// acquisition -> [CABLE: firmware behind one lock] -> host

namespace sonoloft::device_sim {

/// A firmware that several threads use: on one side the host, through protocol::Port, on the other the acquisition.
/// The device's clock is the steady clock. Threads: any member from any thread at any time.
class Cable final : public protocol::Port {
 public:
  using Clock = std::chrono::steady_clock;

  /// @pre `firmware` outlives the cable, and nothing else calls it
  explicit Cable(Firmware& firmware) : firmware_(firmware) {}
  ~Cable() = default;

  // The host's side.
  [[nodiscard]] protocol::PortTransfer control(std::span<const std::byte> request, std::span<std::byte> reply) override;
  [[nodiscard]] protocol::PortTransfer read(std::span<std::byte> record, std::uint32_t timeout_ms) override;
  [[nodiscard]] protocol::PortTransfer read_event(std::span<std::byte> event, std::uint32_t timeout_ms) override;
  [[nodiscard]] protocol::PortTransfer write_block(std::span<const std::byte> block) override;
  void cancel_reads() override;
  void allow_reads() override;

  // The device's side.

  /// Waits until the device streams and the next slice is due: at the time `due`, or, without one, as soon as a
  /// lossless stream has room for it. Looks at the firmware's watchdog meanwhile.
  /// @return false after shut_down() or unplug(): nothing is to be acquired any more
  [[nodiscard]] bool wait_to_acquire(std::optional<Clock::time_point> due);
  void acquire(const AcquiredSlice& slice);
  void end_of_source();
  void button(std::uint16_t number, bool pressed);
  /// Ends every wait of the acquisition, now and later.
  void shut_down();
  /// Pulls the plug: every transfer of the host, now and later, ends with `gone`.
  void unplug();
  [[nodiscard]] protocol::StatsReply stats();

 private:
  using Lock = std::unique_lock<std::mutex>;

  [[nodiscard]] protocol::PortStatus wait_for_host(Lock& lock, std::uint32_t timeout_ms,
                                                   bool (Firmware::*nothing)() const);
  [[nodiscard]] bool may_acquire(std::optional<Clock::time_point> due) const;

  std::mutex mutex_;
  std::condition_variable to_host_;         ///< a record, an event, the end of reads or of the device
  std::condition_variable to_acquisition_;  ///< a request, room in the ring, or the end of the device
  Firmware& firmware_;
  bool gone_ = false, shut_down_ = false, reads_cancelled_ = false;
};

}  // namespace sonoloft::device_sim
