#include "host/device/usb/usb_context.h"

#include <mutex>

#include "host/device/usb/usb_error.h"

namespace sonoloft::device {

Result<std::shared_ptr<UsbContext>> UsbContext::get() {
  static std::mutex mutex;
  static std::weak_ptr<UsbContext> present;
  const std::lock_guard lock(mutex);
  if (auto context = present.lock()) return context;
  libusb_context* libusb = nullptr;
  if (const int status = libusb_init(&libusb); status != 0) return usb_error(status, "USB cannot be used");
  std::shared_ptr<UsbContext> context(new UsbContext(libusb));
  present = context;
  return context;
}

UsbContext::UsbContext(libusb_context* libusb)
    : libusb_(libusb), event_thread_([this] {
        while (!stopping_) libusb_handle_events_completed(libusb_, nullptr);
      }) {}

UsbContext::~UsbContext() {
  stopping_ = true;
  libusb_interrupt_event_handler(libusb_);
  event_thread_.join();
  libusb_exit(libusb_);
}

}  // namespace sonoloft::device
