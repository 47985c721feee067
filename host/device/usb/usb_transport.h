#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <string_view>

#include "host/device/transport.h"

// USB probe -> libusb -> [USB TRANSPORT] -> transfers -> session

namespace sonoloft::device {

class UsbHandle;
class UsbStream;

/// Reaches a probe over USB. Its event thread is a thread of the stream: libusb's own is shared by all devices of the
/// process and never waits for a sink. The sink reads transfers where libusb put them; nothing is copied in between.
///
/// Errors beyond those of the contract: io_failed names its remedy (no permission, used by another program, no memory
/// for transfers). A transfer that the kernel does not give back within 2 s is left to it, with the memory that belongs
/// to it, and the device counts as gone.
class UsbTransport final : public Transport {
 public:
  /// Opens the probe with this serial number, or the only one when it is empty.
  /// @error device_not_found (none, or several and no serial), io_failed, transport_closed, timed_out
  [[nodiscard]] static Result<std::unique_ptr<UsbTransport>> open(std::string_view serial = {});
  ~UsbTransport() override;

  [[nodiscard]] Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                                            std::chrono::milliseconds timeout) override;
  [[nodiscard]] Result<void> start_stream(TransferSink& sink, std::size_t max_record) override;
  [[nodiscard]] Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) override;
  void stop_stream() override;
  void restart_stream() override;
  void reset_stream() override;

  /// A device that is still there is reset as a port reset does; one that left is looked for by its serial number.
  /// @error also device_not_found: it is not back yet
  [[nodiscard]] Result<void> reopen() override;

  [[nodiscard]] const std::string& serial() const { return serial_; }
  /// As negotiated: 12, 480, 5000, ... Mbit/s; 0: unknown.
  [[nodiscard]] int speed_mbit() const;

 private:
  class EventSink;

  UsbTransport(std::unique_ptr<UsbHandle> handle, std::string serial);
  Result<std::size_t> exchange(std::span<const std::byte> request, std::span<std::byte> reply,
                               std::chrono::milliseconds timeout);
  Result<void> drain(std::size_t transfer_size);
  Result<void> begin(std::unique_ptr<UsbStream>& stream, std::unique_ptr<UsbStream> made);
  void end(std::unique_ptr<UsbStream>& stream);
  void note(const Error& error);

  std::unique_ptr<UsbHandle> handle_;
  std::string serial_;
  std::unique_ptr<UsbStream> stream_;
  std::unique_ptr<EventSink> event_sink_;
  std::unique_ptr<UsbStream> events_;  ///< nothing where the device has no endpoint for them
  std::atomic<bool> gone_ = false;
};

}  // namespace sonoloft::device
