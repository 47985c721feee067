#include "host/device/usb/usb_error.h"

#include <libusb-1.0/libusb.h>

namespace sonoloft::device {

tl::unexpected<Error> usb_error(int status, const std::string& what) {
  switch (status) {
    case LIBUSB_ERROR_NO_DEVICE:
      return fail(ErrorCode::transport_closed, what + ": the device was unplugged: plug it in and start again");
    case LIBUSB_ERROR_ACCESS:
      return fail(ErrorCode::io_failed,
                  what + ": no permission: install the udev rule (docs/usb.md), then plug the device in again");
    case LIBUSB_ERROR_BUSY:
      return fail(ErrorCode::io_failed, what + ": another program uses the device: close it");
    case LIBUSB_ERROR_NO_MEM:
      return fail(ErrorCode::io_failed, what +
                                            ": the kernel has no memory for USB transfers left: raise "
                                            "/sys/module/usbcore/parameters/usbfs_memory_mb");
    case LIBUSB_ERROR_TIMEOUT:
      return fail(ErrorCode::timed_out, what + ": no answer: check the cable and start again");
    default:
      return fail(ErrorCode::io_failed, what + ": " + libusb_error_name(status) + ": plug the device in again");
  }
}

tl::unexpected<Error> transfer_error(int status, const std::string& what) {
  switch (status) {
    case LIBUSB_TRANSFER_NO_DEVICE:
      return usb_error(LIBUSB_ERROR_NO_DEVICE, what);
    case LIBUSB_TRANSFER_TIMED_OUT:
    case LIBUSB_TRANSFER_CANCELLED:
      return usb_error(LIBUSB_ERROR_TIMEOUT, what);
    case LIBUSB_TRANSFER_STALL:
      return fail(ErrorCode::io_failed, what + ": the device refused: update its firmware");
    default:
      return usb_error(LIBUSB_ERROR_IO, what);
  }
}

}  // namespace sonoloft::device
