#pragma once
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>

#include "host/device/transport.h"
#include "tests/usb/usbip/usbip_client.h"

namespace sonoloft::test {

/// A session's way to a device over USB/IP: what libusb, usbfs and vhci-hcd do together, in small.
class UsbipTransport final : public device::Transport {
 public:
  explicit UsbipTransport(std::uint16_t tcp_port);
  ~UsbipTransport() override;

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override;
  Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override;
  void stop_stream() override;

  /// Closes the connection, as pulling the plug does.
  void unplug() { client_.shut_down(); }

 private:
  using Reply = UsbipClient::Reply;

  void read_replies();
  Result<Reply> wait_for(std::uint32_t seqnum, std::chrono::milliseconds timeout);
  void pass_on(device::TransferSink& sink);

  UsbipClient client_;
  std::mutex write_mutex_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint32_t, Reply> replies_;
  std::deque<std::uint32_t> in_flight_;  ///< of the stream, in order
  std::size_t transfer_size_ = 0;
  bool gone_ = false, stopping_ = false;
  std::jthread stream_thread_;
  std::jthread reader_;
};

}  // namespace sonoloft::test
