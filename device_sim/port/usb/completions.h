#pragma once
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "device_sim/port/usb/urb.h"

namespace sonoloft::device_sim::usb {

/// An UrbDone with data of its own.
struct Completion {
  std::uint64_t id;
  UrbStatus status;
  std::vector<std::byte> data;
  std::size_t size;
};

/// Hands completions from the threads of a device model to the one loop that serves a bus, which finds them, and what
/// else it is woken for, with poll(). Threads: add() and wake() from any, take() from the loop's.
class Completions {
 public:
  Completions();
  ~Completions();
  Completions(const Completions&) = delete;
  Completions& operator=(const Completions&) = delete;

  /// What an UrbSink does.
  void add(const UrbDone& done);
  void wake();
  /// An eventfd, readable where there is something to take.
  [[nodiscard]] int event() const { return event_; }
  /// All there are, in order; afterwards the event is quiet.
  [[nodiscard]] std::vector<Completion> take();

 private:
  const int event_;
  std::mutex mutex_;  ///< held for moments
  std::vector<Completion> waiting_;
};

}  // namespace sonoloft::device_sim::usb
