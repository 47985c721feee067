#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "device_sim/port/fault/fault_plan.h"
#include "protocol/port.h"

// firmware -> cable -> [FAULTY PORT] -> any bus

namespace sonoloft::device_sim {

/// What a FaultyPort did, exact once the stream has stopped.
struct FaultCounts {
  std::atomic<std::uint64_t> lost = 0;      ///< records that never came
  std::atomic<std::uint64_t> altered = 0;   ///< records that came, but not as they were sent
  std::atomic<std::uint64_t> repeated = 0;  ///< records too many: repeated, late, or of an earlier session
  std::atomic<std::uint64_t> held = 0;      ///< records that came late, but in order
  std::atomic<std::uint64_t> requests = 0;  ///< requests or replies that suffered
};

/// Passes a port on and brings about what a plan says. Whatever bus is put on top of it gets the same faults: the
/// loopback, or the simulated USB device and its servers. Threads: as protocol::Port.
class FaultyPort final : public protocol::Port {
 public:
  /// Faultless until set_plan(). @pre `port` outlives this one
  explicit FaultyPort(protocol::Port& port) : port_(port), plan_(FaultKind::none, 0, 1) {}
  ~FaultyPort() = default;

  /// @pre no stream runs
  void set_plan(const FaultPlan& plan);
  /// Whether a fault has ended all that can come.
  [[nodiscard]] bool dead() const;
  [[nodiscard]] const FaultCounts& counts() const { return counts_; }

  [[nodiscard]] protocol::PortTransfer control(std::span<const std::byte> request, std::span<std::byte> reply) override;
  [[nodiscard]] protocol::PortTransfer read(std::span<std::byte> record, std::uint32_t timeout_ms) override;
  [[nodiscard]] protocol::PortTransfer read_event(std::span<std::byte> event, std::uint32_t timeout_ms) override;
  [[nodiscard]] protocol::PortTransfer write_block(std::span<const std::byte> block) override;
  void cancel_reads() override;
  void allow_reads() override;
  void clear_halt() override;

 private:
  using Lock = std::unique_lock<std::mutex>;

  std::optional<protocol::PortTransfer> answer_for_port(std::span<std::byte> record, std::uint32_t timeout_ms);
  protocol::PortTransfer wait_in_silence(Lock& lock, std::uint32_t timeout_ms);
  void remember(std::span<const std::byte> record);
  protocol::PortTransfer strike(std::span<std::byte> record, std::size_t size, std::uint32_t timeout_ms);
  protocol::PortTransfer swap(std::span<std::byte> record, std::size_t size, std::uint32_t timeout_ms);
  std::size_t extend(std::span<std::byte> record, std::size_t size);
  void flip(std::span<std::byte> record);
  void hold(std::chrono::milliseconds duration);
  void restart_device();
  void become(bool& state);

  protocol::Port& port_;
  FaultCounts counts_;

  mutable std::mutex mutex_;  ///< guards what follows; not held while the port is used
  std::condition_variable changed_;
  FaultPlan plan_;
  bool cancelled_ = false, halted_ = false;
  bool gone_ = false, mute_ = false, deaf_ = false;  ///< for ever: no cable, no records, no replies
  std::vector<std::byte> next_;                      ///< comes before the port is asked again
  std::vector<std::byte> last_, stale_;              ///< the newest record, and that of the session before
};

}  // namespace sonoloft::device_sim
