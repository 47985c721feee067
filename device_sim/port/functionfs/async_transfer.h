#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonoloft::device_sim::functionfs {

/// Writes to a file, or reads from it, one at a time without waiting, by Linux' own asynchronous I/O: the one that an
/// endpoint's file can be made to give up. Threads: the caller's one.
class AsyncTransfer {
 public:
  /// @param event  an eventfd, raised at the end of every transfer
  explicit AsyncTransfer(int event);
  /// Cancels what is under way.
  ~AsyncTransfer();
  AsyncTransfer(const AsyncTransfer&) = delete;
  AsyncTransfer& operator=(const AsyncTransfer&) = delete;

  /// Whether the kernel has room for it; @pre of what follows.
  [[nodiscard]] bool ready() const { return context_ != 0; }
  /// @pre not busy(). What cannot be written is lost.
  void write(int file, std::vector<std::byte> bytes);
  /// @pre not busy()
  void read(int file, std::size_t room);
  [[nodiscard]] bool busy();
  /// What was read, once; empty where nothing came. @pre not busy()
  [[nodiscard]] std::vector<std::byte> take();

 private:
  void begin(int file, std::uint16_t what);

  const int event_;
  unsigned long context_ = 0;
  std::vector<std::byte> bytes_;
  bool busy_ = false;
};

}  // namespace sonoloft::device_sim::functionfs
