#pragma once
#include <libusb-1.0/libusb.h>

#include <atomic>
#include <memory>
#include <thread>

#include "core/slice/result.h"

namespace sonoloft::device {

/// libusb with its event thread, one for the process: there while somebody holds it. All transfers are asynchronous,
/// because libusb 1.0.26 may use freed memory when its synchronous calls meet an event thread.
/// Threads: any but the event thread, which must not let go of the last handle to it.
class UsbContext {
 public:
  /// @error io_failed (no USB here)
  [[nodiscard]] static Result<std::shared_ptr<UsbContext>> get();
  ~UsbContext();
  UsbContext(const UsbContext&) = delete;
  UsbContext& operator=(const UsbContext&) = delete;

  [[nodiscard]] libusb_context* libusb() const { return libusb_; }

 private:
  explicit UsbContext(libusb_context* libusb);

  libusb_context* libusb_;
  std::atomic<bool> stopping_ = false;
  std::jthread event_thread_;
};

}  // namespace sonoloft::device
