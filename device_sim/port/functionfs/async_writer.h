#pragma once
#include <cstddef>
#include <vector>

namespace sonoloft::device_sim::functionfs {

/// Writes to a file one at a time without waiting, by Linux' own asynchronous I/O: the one that an endpoint's file can
/// be made to give up. Threads: the caller's one.
class AsyncWriter {
 public:
  /// @param event  an eventfd, raised at the end of every write
  explicit AsyncWriter(int event);
  /// Cancels what is under way.
  ~AsyncWriter();
  AsyncWriter(const AsyncWriter&) = delete;
  AsyncWriter& operator=(const AsyncWriter&) = delete;

  /// Whether the kernel has room for it; @pre of begin().
  [[nodiscard]] bool ready() const { return context_ != 0; }
  /// @pre not busy(). What cannot be written is lost.
  void begin(int file, std::vector<std::byte> bytes);
  [[nodiscard]] bool busy();

 private:
  const int event_;
  unsigned long context_ = 0;
  std::vector<std::byte> bytes_;
  bool busy_ = false;
};

}  // namespace sonoloft::device_sim::functionfs
