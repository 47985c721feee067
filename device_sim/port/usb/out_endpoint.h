#pragma once
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "device_sim/port/usb/urb.h"
#include "protocol/port.h"

namespace sonoloft::device_sim::usb {

/// An OUT endpoint: joins what the host sends into messages, each from a packet's begin to a short packet, as a
/// controller does; URBs that end with a whole packet go on in the next. A URB completes when what it ended was taken.
/// Threads: one of its own, on which messages are taken; members from any thread.
class OutEndpoint {
 public:
  /// Takes a message; any bytes.
  using Write = std::function<protocol::PortTransfer(std::span<const std::byte> message)>;

  /// A message that is longer than max_message is thrown away.
  OutEndpoint(std::size_t max_packet, std::size_t max_message, Write write, UrbSink done);
  /// Waits for a message that is being taken. No completion follows.
  ~OutEndpoint();
  OutEndpoint(const OutEndpoint&) = delete;
  OutEndpoint& operator=(const OutEndpoint&) = delete;

  void submit(Urb urb);
  /// @return whether it waited, or was being taken: then it completes never. Else its completion has been called.
  bool unlink(std::uint64_t id);
  /// All waiting URBs, and every one until clear_halt(), stall.
  void halt();
  /// Also throws away a message that had begun.
  void clear_halt();
  [[nodiscard]] bool halted() const;
  /// Forgets URBs without completing them and a message that had begun, and clears the halt.
  void reset();

 private:
  void pump();
  /// Of the URB in front. @return how it ends
  UrbStatus take(std::unique_lock<std::mutex>& lock, const Urb& urb);

  const std::size_t max_packet_, max_message_;
  const Write write_;
  const UrbSink done_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Urb> waiting_;
  std::optional<std::uint64_t> taking_;  ///< empty too when it was unlinked meanwhile
  std::vector<std::byte> message_;       ///< what came of it so far
  bool halted_ = false, gone_ = false, closing_ = false;
  std::jthread thread_;
};

}  // namespace sonoloft::device_sim::usb
