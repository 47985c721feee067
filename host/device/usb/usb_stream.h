#pragma once
#include <libusb-1.0/libusb.h>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "core/slice/result.h"
#include "host/device/transport.h"

namespace sonoloft::device {

/// The transfers of one IN endpoint, bulk or interrupt. libusb's event thread gathers finished ones, a thread of the
/// stream hands their buffers to the sink where they lie and submits them again: a sink that blocks holds nothing up
/// but its own stream. Threads: one at a time, but for restart() and reset(), which any thread may call that is not the
/// sink's.
class UsbStream {
 public:
  /// `count` transfers of `size` bytes on `endpoint`.
  /// @pre `handle` and `sink` outlive it; size is a multiple of 1024
  UsbStream(libusb_device_handle* handle, std::uint8_t endpoint, libusb_transfer_type type, std::size_t count,
            std::size_t size, TransferSink& sink);
  /// @pre never begun, or end() returned true afterwards
  ~UsbStream();

  /// @error transport_closed, io_failed (no memory for transfers): end() is due all the same
  [[nodiscard]] Result<void> begin();

  /// Cancels, and waits until everything that had finished is handed over and the kernel has given all back.
  /// @return false: it kept something for 2 s. Then neither the stream nor the handle may be destroyed.
  [[nodiscard]] bool end();

  /// Takes all transfers back, clears the endpoint's halt and submits them again.
  void restart();
  /// The same with a reset of the device's port; returns when that is over.
  void reset();

 private:
  struct Slot {
    UsbStream* stream;
    libusb_transfer* transfer;
  };

  static void LIBUSB_CALL on_completed(libusb_transfer* transfer);
  void take_back(Slot& slot);

  void run();
  void hand_over(std::unique_lock<std::mutex>& lock);
  void mend(std::unique_lock<std::mutex>& lock);
  void submit(Slot& slot);
  void submit_idle();
  void cancel_all();

  libusb_device_handle* const handle_;
  const std::uint8_t endpoint_;
  TransferSink& sink_;
  std::vector<std::byte> memory_;
  std::vector<Slot> slots_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Slot*> ready_;  ///< finished, to be handed over
  std::vector<Slot*> idle_;  ///< came back without data
  std::size_t active_ = 0;   ///< with the kernel
  int failures_ = 0;         ///< in a row
  int refusal_ = 0;          ///< why the last submission failed
  bool resetting_ = false;
  bool halted_ = false, failed_ = false, gone_ = false, stopping_ = false, abandoned_ = false;
  std::jthread thread_;
};

}  // namespace sonoloft::device
