#include "tests/usb/usbip/served_transport.h"

#include <stdexcept>
#include <utility>

#include "device_sim/port/usbip/usbip_server.h"
#include "tests/usb/usbip/usbip_transport.h"

namespace sonoloft::test {
namespace {

using device_sim::usbip::UsbipServer;

class ServedTransport final : public device::Transport {
 public:
  explicit ServedTransport(std::unique_ptr<UsbipServer> server)
      : server_(std::move(server)), host_(server_->tcp_port()) {}

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override {
    return host_.control(request, reply, timeout);
  }
  Result<void> start_stream(device::TransferSink& sink, std::size_t max_record) override {
    return host_.start_stream(sink, max_record);
  }
  void stop_stream() override { host_.stop_stream(); }
  Result<void> send_block(std::span<const std::byte> block, std::chrono::milliseconds timeout) override {
    return host_.send_block(block, timeout);
  }

 private:
  std::unique_ptr<UsbipServer> server_;
  UsbipTransport host_;
};

}  // namespace

std::unique_ptr<device::Transport> serve_over_usbip(protocol::Port& port,
                                                    const device_sim::usb::UsbIdentity& identity) {
  auto made = UsbipServer::start(port, identity, 0);
  if (!made.value) throw std::runtime_error(made.error);
  return std::make_unique<ServedTransport>(std::move(made.value));
}

}  // namespace sonoloft::test
