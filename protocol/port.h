#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonoloft::protocol {

/// How a transfer over a port ended.
enum class PortStatus : std::uint8_t {
  ok,
  timed_out,  ///< of a request: its reply never came; it may have been carried out or not
  cancelled,  ///< by cancel_reads()
  halted,     ///< the stream's endpoint refuses until clear_halt(); what was under way is lost
  gone,       ///< the cable was pulled: this and every later transfer
};

struct PortTransfer {
  PortStatus status;
  std::size_t size;  ///< bytes written into the caller's buffer; 0 unless ok
};

/// What a bus offers between the two sides when both are in one process: requests with their replies, a stream of
/// records, events, and a way for blobs. The far side of the cable implements it, the near side uses it; neither knows
/// the other. Threads: every member may be called from any thread at any time; transfers of one kind wait for each
/// other.
class Port {
 public:
  /// Sends a request and receives its reply, as a control transfer does.
  /// @pre request.size() <= kMaxRequestLen, reply.size() >= kMaxRequestLen (see command.h); any bytes are legal
  [[nodiscard]] virtual PortTransfer control(std::span<const std::byte> request, std::span<std::byte> reply) = 0;

  /// Receives one record, waiting for it up to `timeout_ms`.
  /// @pre record.size() >= the device's max_record
  [[nodiscard]] virtual PortTransfer read(std::span<std::byte> record, std::uint32_t timeout_ms) = 0;

  /// Receives one event, waiting for it up to `timeout_ms`. Never halts.
  /// @pre event.size() >= kEventLen (see event.h)
  [[nodiscard]] virtual PortTransfer read_event(std::span<std::byte> event, std::uint32_t timeout_ms) = 0;

  /// Sends one block of a blob (see block.h); ok: the device has looked at it, whatever it thinks of it.
  /// @pre block.size() <= the device's max_block
  [[nodiscard]] virtual PortTransfer write_block(std::span<const std::byte> block) = 0;

  /// Ends reads of either kind that wait now, and every one until allow_reads(), with `cancelled`.
  virtual void cancel_reads() = 0;
  virtual void allow_reads() = 0;

  /// Lets a halted stream go on; nothing otherwise. A port that never halts need not override it.
  virtual void clear_halt() {}

 protected:
  ~Port() = default;
};

}  // namespace sonoloft::protocol
