#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>

#include "core/slice/result.h"
#include "host/device/transport.h"
#include "protocol/command.h"

namespace sonoloft::device {

/// Asks a device and understands its answers: numbers the requests, repeats those that the device puts off, turns
/// statuses into errors. Threads: any but the transport's event thread; one request at a time, others wait.
class Requester {
 public:
  static constexpr std::chrono::milliseconds kPatience{1000};

  /// @pre `transport` outlives the requester
  explicit Requester(Transport& transport) : transport_(transport) {}

  /// A request whose reply has nothing to say but ok.
  /// @error transport_closed, timed_out (also: still busy or pending after `patience`), io_failed,
  ///        wrong_state, not_available (no such command), refused_by_device, protocol_mismatch (no sensible reply)
  [[nodiscard]] Result<void> tell(protocol::Command command, std::span<const std::byte> payload = {},
                                  std::chrono::milliseconds patience = kPatience);

  /// A request whose reply carries a Reply. @error as tell(); protocol_mismatch also for a reply that is too short
  template <class Reply>
  [[nodiscard]] Result<Reply> ask(protocol::Command command, std::span<const std::byte> payload = {},
                                  std::chrono::milliseconds patience = kPatience) {
    const std::lock_guard lock(mutex_);
    const auto bytes = exchange(command, payload, patience);
    if (!bytes) return tl::unexpected(bytes.error());
    Reply reply;
    if (!protocol::read_payload(*bytes, reply)) return short_reply(command, bytes->size(), sizeof reply);
    return reply;
  }

 private:
  using Clock = std::chrono::steady_clock;

  // The payload of an ok reply, valid until the next exchange. Call with mutex_ held.
  Result<std::span<const std::byte>> exchange(protocol::Command command, std::span<const std::byte> payload,
                                              std::chrono::milliseconds patience);
  Result<protocol::ReplyView> exchange_once(std::span<const std::byte> request, std::uint32_t request_id,
                                            std::chrono::milliseconds timeout);
  static tl::unexpected<Error> short_reply(protocol::Command command, std::size_t have, std::size_t need);

  Transport& transport_;
  std::mutex mutex_;
  std::uint32_t next_id_ = 1;
  std::array<std::byte, protocol::kMaxRequestLen> request_, reply_;
};

}  // namespace sonoloft::device
