#pragma once
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace sonoloft::test {

/// A host's end of USB/IP, by the book and without a kernel. Calls wait, at most 60 s; a server that is none throws.
/// Threads: one reads, one writes.
class UsbipClient {
 public:
  struct Reply {
    std::uint32_t command, seqnum;
    std::int32_t status;
    std::vector<std::byte> data;
    std::uint32_t actual_length;
  };

  explicit UsbipClient(std::uint16_t tcp_port);
  ~UsbipClient();
  UsbipClient(const UsbipClient&) = delete;
  UsbipClient& operator=(const UsbipClient&) = delete;

  void send(std::span<const std::byte> bytes);
  /// Empty where the server has closed.
  [[nodiscard]] std::optional<std::vector<std::byte>> receive(std::size_t size);
  /// Ends both directions, so that a waiting receive() returns.
  void shut_down();
  /// Does so when this many bytes more were sent.
  void cut_after(std::size_t bytes) { left_ = bytes; }

  /// OP_REQ_DEVLIST. @return the whole reply for one device with one interface
  [[nodiscard]] std::vector<std::byte> list();
  /// OP_REQ_IMPORT. @return the status
  [[nodiscard]] std::uint32_t import(const char* bus_id = "1-1");

  /// Transfers to endpoint 0 by their setup, else IN.
  /// @return the sequence number
  std::uint32_t submit(std::uint32_t endpoint, std::uint32_t length);
  std::uint32_t submit_out(std::uint32_t endpoint, std::span<const std::byte> data);
  std::uint32_t submit_control(std::uint8_t request_type, std::uint8_t request, std::uint16_t value,
                               std::uint16_t length, std::span<const std::byte> data = {}, std::uint16_t index = 0);
  std::uint32_t unlink(std::uint32_t seqnum);
  [[nodiscard]] std::optional<Reply> next_reply();

 private:
  std::uint32_t command(std::uint32_t code, std::uint32_t direction, std::uint32_t endpoint, std::uint32_t third,
                        std::uint32_t length, std::span<const std::byte> setup, std::span<const std::byte> data);

  int socket_;
  std::size_t left_ = SIZE_MAX;  ///< bytes that may still be sent
  std::uint32_t next_seqnum_ = 1;
  std::mutex mutex_;
  std::set<std::uint32_t> inbound_;  ///< IN transfers under way
};

}  // namespace sonoloft::test
