#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonoloft::protocol {

/// How a transfer over a port ended.
enum class PortStatus : std::uint8_t {
  ok,
  timed_out,
  cancelled,  ///< by cancel_reads()
  gone,       ///< the cable was pulled: this and every later transfer
};

struct PortTransfer {
  PortStatus status;
  std::size_t size;  ///< bytes written into the caller's buffer; 0 unless ok
};

/// What a bus offers between the two sides when both are in one process: requests with their replies, and a stream of
/// records. The far side of the cable implements it, the near side uses it; neither knows the other.
/// Threads: every member may be called from any thread at any time; transfers of one kind wait for each other.
class Port {
 public:
  /// Sends a request and receives its reply, as a control transfer does.
  /// @pre 8 <= request.size() <= kMaxRequestLen, reply.size() >= kMaxRequestLen (see command.h)
  [[nodiscard]] virtual PortTransfer control(std::span<const std::byte> request, std::span<std::byte> reply) = 0;

  /// Receives one record, waiting for it up to `timeout_ms`.
  /// @pre record.size() >= the device's max_record
  [[nodiscard]] virtual PortTransfer read(std::span<std::byte> record, std::uint32_t timeout_ms) = 0;

  /// Ends a read that waits now, and every one until allow_reads(), with `cancelled`.
  virtual void cancel_reads() = 0;
  virtual void allow_reads() = 0;

 protected:
  ~Port() = default;
};

}  // namespace sonoloft::protocol
