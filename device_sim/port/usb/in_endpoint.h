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

/// An IN endpoint: cuts the messages of a source into the URBs that wait, as a controller does with packets. A message
/// begins a URB and ends it with a short packet; one that is longer than the URB goes on in the next. The source is
/// asked only while a URB waits, so nothing leaves it that nobody takes.
/// Threads: one of its own, on which the source is asked; members from any thread.
class InEndpoint {
 public:
  /// Waits a while for the next message and writes it; the end of its waiting is the source's affair. A source that
  /// is halted halts the endpoint.
  using Read = std::function<protocol::PortTransfer(std::span<std::byte> message)>;

  /// @pre every message fits into max_message; no length of a message is a multiple of max_packet
  InEndpoint(std::size_t max_packet, std::size_t max_message, Read read, UrbSink done);
  /// Waits for the source. No completion follows.
  ~InEndpoint();
  InEndpoint(const InEndpoint&) = delete;
  InEndpoint& operator=(const InEndpoint&) = delete;

  void submit(std::uint64_t id, std::size_t room);
  /// @return whether it waited: then it completes never. Else its completion has been called.
  bool unlink(std::uint64_t id);
  /// All waiting URBs, and every one until clear_halt(), stall.
  void halt();
  /// Also throws away what was left of a message that had begun: the next URB begins with a message.
  void clear_halt();
  [[nodiscard]] bool halted() const;
  /// Forgets waiting URBs without completing them, and what was fetched for them, and clears the halt.
  void reset();

 private:
  struct Waiting {
    std::uint64_t id;
    std::size_t room;
  };

  void pump();
  void fetch(std::unique_lock<std::mutex>& lock);
  void hand_over();
  void complete_all(UrbStatus status);

  const std::size_t max_packet_;
  const Read read_;
  const UrbSink done_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Waiting> waiting_;
  std::vector<std::byte> buffer_;                      ///< the pump's while it fetches
  std::optional<std::span<const std::byte>> message_;  ///< what is left of it: no bytes are a message, too
  std::uint32_t resets_ = 0;
  bool halted_ = false, gone_ = false, closing_ = false;
  std::jthread thread_;
};

}  // namespace sonoloft::device_sim::usb
