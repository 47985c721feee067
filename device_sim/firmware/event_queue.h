#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/event.h"

namespace sonoloft::device_sim {

/// Events that wait for the host. Of more than fit the oldest are lost, and the gap in their numbers says so.
/// Threads: one at a time.
class EventQueue {
 public:
  /// A session begins: nothing waits, numbers begin at 0.
  void begin(std::uint32_t session_id);
  /// Forgets what waits.
  void clear() { used_ = 0; }
  /// @param event  without session, sequence number and sum
  void push(protocol::EventMessage event);
  [[nodiscard]] bool empty() const { return used_ == 0; }
  /// Writes the oldest event. @pre out.size() >= kEventLen @return its length, 0 when there is none
  [[nodiscard]] std::size_t take(std::span<std::byte> out);

 private:
  static constexpr std::size_t kCapacity = 16;

  std::array<protocol::EventMessage, kCapacity> events_{};
  std::size_t first_ = 0, used_ = 0;
  std::uint32_t session_id_ = 0, next_seq_ = 0;
};

}  // namespace sonoloft::device_sim
