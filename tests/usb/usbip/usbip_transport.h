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
  Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) override;

  /// Closes the connection, as pulling the plug does.
  void unplug() { client_.shut_down(); }

 private:
  using Reply = UsbipClient::Reply;
  using Lock = std::unique_lock<std::mutex>;

  void read_replies();
  /// How a transfer ended; one that has not after `timeout` is taken back.
  Result<Reply> finish(std::uint32_t seqnum, std::chrono::milliseconds timeout);
  std::optional<Reply> take(std::uint32_t seqnum);
  /// Nothing where the transfer was cancelled.
  std::optional<Reply> take_back(Lock& lock, std::uint32_t seqnum);
  template <class Submit>
  std::uint32_t submit(const Submit& submit);

  void pass_on(device::TransferSink& sink);
  void pass_on_events(device::TransferSink& sink);
  void submit_transfers();
  void hand_over(Lock& lock, const Reply& reply, device::TransferSink& sink);
  void take_all_back(Lock& lock, device::TransferSink& sink);
  void clear_halt();

  UsbipClient client_;
  std::mutex write_mutex_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::uint32_t, Reply> replies_;
  std::deque<std::uint32_t> in_flight_;  ///< of the stream, in order
  std::size_t transfer_size_ = 0;
  bool gone_ = false, stopping_ = false;
  std::jthread stream_thread_, events_thread_;
  std::jthread reader_;
};

}  // namespace sonoloft::test
