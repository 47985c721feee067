#pragma once
#include <usbredirparser.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace sonoloft::test {

/// A virtual machine's end of a redirected device, without the machine. Calls wait, at most 60 s.
class RedirectedDevice {
 public:
  /// What the server sent: `status` of a transfer, `number` of a configuration.
  struct Packet {
    enum class Kind { connect, disconnect, control, bulk, configuration, alt_setting, receiving, interrupt } kind;
    std::uint64_t id = 0;
    std::uint8_t status = 0;
    std::uint32_t length = 0;
    std::vector<std::byte> data = {};
    std::uint8_t number = 0;
  };

  explicit RedirectedDevice(std::uint16_t tcp_port, bool greets = true);
  ~RedirectedDevice();
  RedirectedDevice(const RedirectedDevice&) = delete;
  RedirectedDevice& operator=(const RedirectedDevice&) = delete;

  /// Empty where the server has closed.
  [[nodiscard]] std::optional<Packet> next();
  [[nodiscard]] bool silent() const;  ///< for now

  void submit_control(std::uint64_t id, std::uint8_t request_type, std::uint8_t request, std::uint16_t value,
                      std::uint16_t length, std::span<const std::byte> data = {});
  void submit_bulk(std::uint64_t id, std::uint8_t endpoint, std::uint32_t length);
  void submit_bulk_out(std::uint64_t id, std::uint8_t endpoint, std::span<const std::byte> data);
  void start_receiving(std::uint64_t id, std::uint8_t endpoint);
  void stop_receiving(std::uint64_t id, std::uint8_t endpoint);
  void cancel(std::uint64_t id);
  void set_configuration(std::uint64_t id, std::uint8_t number);
  void get_alt_setting(std::uint64_t id);
  void reset();
  void send_raw(std::span<const std::byte> bytes);

  // What the server said when it greeted back.
  usb_redir_device_connect_header connected{};
  usb_redir_interface_info_header interface {};
  usb_redir_ep_info_header endpoints{};

 private:
  void set_callbacks();
  void flush();

  struct Destroy {
    void operator()(usbredirparser* parser) const { usbredirparser_destroy(parser); }
  };
  const int socket_;
  std::unique_ptr<usbredirparser, Destroy> parser_;
  std::deque<Packet> packets_;
};

}  // namespace sonoloft::test
