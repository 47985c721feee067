#pragma once
#include <libusb-1.0/libusb.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/slice/result.h"
#include "host/device/usb/usb_context.h"

namespace sonoloft::device {

/// Where the protocol is spoken, out of a device's descriptors.
struct UsbInterface {
  std::uint8_t number, stream_in;
  std::uint8_t event_in = 0, blob_out = 0;  ///< 0: it has none
};

/// nullopt: no probe. Opens nothing.
[[nodiscard]] std::optional<UsbInterface> find_interface(libusb_device* device);

/// An opened USB device, perhaps with its interface claimed. Threads: any but the event thread.
class UsbHandle {
 public:
  /// @pre find_interface(device) gave `interface` @error io_failed (no permission), transport_closed
  [[nodiscard]] static Result<std::unique_ptr<UsbHandle>> open(std::shared_ptr<UsbContext> context,
                                                               libusb_device* device, const UsbInterface& interface);
  ~UsbHandle();
  UsbHandle(const UsbHandle&) = delete;
  UsbHandle& operator=(const UsbHandle&) = delete;

  /// Keeps other programs away. @error io_failed (another program uses it), transport_closed
  [[nodiscard]] Result<void> claim();

  /// A control transfer, to the device or, by request_type, from it. @return the bytes moved
  /// @error transport_closed, timed_out, io_failed
  [[nodiscard]] Result<std::size_t> control(const libusb_control_setup& setup, std::span<std::byte> data,
                                            std::chrono::milliseconds timeout);

  /// Writes to a bulk endpoint. @error as control(); an endpoint that was halted is let go on
  [[nodiscard]] Result<void> write(std::uint8_t endpoint, std::span<const std::byte> data,
                                   std::chrono::milliseconds timeout);

  /// The serial number. @error as control(); protocol_mismatch (it has none)
  [[nodiscard]] Result<std::string> serial();

  [[nodiscard]] libusb_device_handle* libusb() const { return handle_; }
  [[nodiscard]] const UsbInterface& interface() const { return interface_; }

  /// Something of it never came back from the kernel: it will not be closed, for that would free what is in use.
  void abandon() { abandoned_ = true; }

 private:
  struct Transfer;
  Result<std::size_t> finish(const std::shared_ptr<Transfer>& transfer, std::chrono::milliseconds timeout,
                             const std::string& what);
  UsbHandle(std::shared_ptr<UsbContext> context, libusb_device_handle* handle, const UsbInterface& interface)
      : context_(std::move(context)), handle_(handle), interface_(interface) {}

  std::shared_ptr<UsbContext> context_;
  libusb_device_handle* handle_;
  UsbInterface interface_;
  bool claimed_ = false, abandoned_ = false;
};

}  // namespace sonoloft::device
