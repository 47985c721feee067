#include "tests/usb/usbredir/redirected_device.h"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace sonoloft::test {
namespace {

using Kind = RedirectedDevice::Packet::Kind;

RedirectedDevice& self_of(void* self) {
  return *static_cast<RedirectedDevice*>(self);
}

}  // namespace

RedirectedDevice::RedirectedDevice(std::uint16_t tcp_port, bool greets)
    : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)), parser_(usbredirparser_create()) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(tcp_port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  parser_->priv = this;
  set_callbacks();
  // Those of QEMU 7.2.
  std::uint32_t capabilities[USB_REDIR_CAPS_SIZE] = {};
  for (const int capability :
       {usb_redir_cap_connect_device_version, usb_redir_cap_filter, usb_redir_cap_ep_info_max_packet_size,
        usb_redir_cap_64bits_ids, usb_redir_cap_32bits_bulk_length, usb_redir_cap_bulk_receiving,
        usb_redir_cap_bulk_streams}) {
    usbredirparser_caps_set_cap(capabilities, capability);
  }
  usbredirparser_init(parser_.get(), "a test", capabilities, USB_REDIR_CAPS_SIZE,
                      greets ? 0 : usbredirparser_fl_no_hello);
  flush();
}

RedirectedDevice::~RedirectedDevice() {
  close(socket_);
}

void RedirectedDevice::set_callbacks() {
  usbredirparser& p = *parser_;
  p.log_func = [](void*, int, const char*) {};
  p.read_func = [](void* self, std::uint8_t* data, int count) {
    const ssize_t size = recv(self_of(self).socket_, data, static_cast<std::size_t>(count), MSG_DONTWAIT);
    if (size < 0 && errno == EAGAIN) return 0;
    return size > 0 ? static_cast<int>(size) : -1;
  };
  p.write_func = [](void* self, std::uint8_t* data, int count) {
    return static_cast<int>(::send(self_of(self).socket_, data, static_cast<std::size_t>(count), MSG_NOSIGNAL));
  };
  p.hello_func = [](void*, usb_redir_hello_header*) {};
  p.interface_info_func = [](void* self, usb_redir_interface_info_header* info) { self_of(self).interface = *info; };
  p.ep_info_func = [](void* self, usb_redir_ep_info_header* info) { self_of(self).endpoints = *info; };
  p.device_connect_func = [](void* self, usb_redir_device_connect_header* header) {
    self_of(self).connected = *header;
    self_of(self).packets_.push_back({Kind::connect});
  };
  p.device_disconnect_func = [](void* self) { self_of(self).packets_.push_back({Kind::disconnect}); };
  p.configuration_status_func = [](void* self, std::uint64_t id, usb_redir_configuration_status_header* header) {
    self_of(self).packets_.push_back({Kind::configuration, id, header->status, 0, {}, header->configuration});
  };
  p.alt_setting_status_func = [](void* self, std::uint64_t id, usb_redir_alt_setting_status_header* header) {
    self_of(self).packets_.push_back({Kind::alt_setting, id, header->status, 0, {}, header->alt});
  };
  static constexpr auto kKeep = [](void* self, Kind kind, std::uint64_t id, std::uint8_t status, std::uint32_t length,
                                   std::uint8_t* data, int len) {
    const auto bytes = std::as_bytes(std::span(data, static_cast<std::size_t>(len)));
    self_of(self).packets_.push_back({kind, id, status, length, {bytes.begin(), bytes.end()}});
    usbredirparser_free_packet_data(self_of(self).parser_.get(), data);
  };
  p.control_packet_func = [](void* self, std::uint64_t id, usb_redir_control_packet_header* header, std::uint8_t* data,
                             int len) { kKeep(self, Kind::control, id, header->status, header->length, data, len); };
  p.interrupt_receiving_status_func = [](void* self, std::uint64_t id,
                                         usb_redir_interrupt_receiving_status_header* header) {
    self_of(self).packets_.push_back({Kind::receiving, id, header->status});
  };
  p.interrupt_packet_func = [](void* self, std::uint64_t id, usb_redir_interrupt_packet_header* header,
                               std::uint8_t* data, int len) {
    kKeep(self, Kind::interrupt, id, header->status, header->length, data, len);
  };
  p.bulk_packet_func = [](void* self, std::uint64_t id, usb_redir_bulk_packet_header* header, std::uint8_t* data,
                          int len) {
    const std::uint32_t length = header->length_high * 0x10000u + header->length;
    kKeep(self, Kind::bulk, id, header->status, length, data, len);
  };
}

void RedirectedDevice::submit_bulk_out(std::uint64_t id, std::uint8_t endpoint, std::span<const std::byte> data) {
  usb_redir_bulk_packet_header header{endpoint, 0, static_cast<std::uint16_t>(data.size()), 0, 0};
  std::vector<std::byte> sent(data.begin(), data.end());
  usbredirparser_send_bulk_packet(parser_.get(), id, &header, reinterpret_cast<std::uint8_t*>(sent.data()),
                                  static_cast<int>(sent.size()));
  flush();
}

void RedirectedDevice::start_receiving(std::uint64_t id, std::uint8_t endpoint) {
  usb_redir_start_interrupt_receiving_header header{endpoint};
  usbredirparser_send_start_interrupt_receiving(parser_.get(), id, &header);
  flush();
}

void RedirectedDevice::stop_receiving(std::uint64_t id, std::uint8_t endpoint) {
  usb_redir_stop_interrupt_receiving_header header{endpoint};
  usbredirparser_send_stop_interrupt_receiving(parser_.get(), id, &header);
  flush();
}

std::optional<RedirectedDevice::Packet> RedirectedDevice::next() {
  constexpr int kPatience_ms = 60'000;
  pollfd polled{socket_, POLLIN, 0};
  while (packets_.empty()) {
    if (poll(&polled, 1, kPatience_ms) != 1 || usbredirparser_do_read(parser_.get()) != 0) break;
  }
  if (packets_.empty()) return std::nullopt;
  Packet packet = std::move(packets_.front());
  packets_.pop_front();
  return packet;
}

bool RedirectedDevice::silent() const {
  pollfd polled{socket_, POLLIN, 0};
  return packets_.empty() && poll(&polled, 1, 0) == 0;
}

void RedirectedDevice::flush() {
  (void)usbredirparser_do_write(parser_.get());  // that the server has closed shows when reading
}

void RedirectedDevice::submit_control(std::uint64_t id, std::uint8_t request_type, std::uint8_t request,
                                      std::uint16_t value, std::uint16_t length, std::span<const std::byte> data) {
  usb_redir_control_packet_header header{
      static_cast<std::uint8_t>(request_type & 0x80), request, request_type, 0, value, 0, length};
  std::vector<std::byte> sent(data.begin(), data.end());
  usbredirparser_send_control_packet(parser_.get(), id, &header, reinterpret_cast<std::uint8_t*>(sent.data()),
                                     static_cast<int>(sent.size()));
  flush();
}

void RedirectedDevice::submit_bulk(std::uint64_t id, std::uint8_t endpoint, std::uint32_t length) {
  usb_redir_bulk_packet_header header{endpoint, 0, static_cast<std::uint16_t>(length & 0xFFFF), 0,
                                      static_cast<std::uint16_t>(length >> 16)};
  usbredirparser_send_bulk_packet(parser_.get(), id, &header, nullptr, 0);
  flush();
}

void RedirectedDevice::cancel(std::uint64_t id) {
  usbredirparser_send_cancel_data_packet(parser_.get(), id);
  flush();
}

void RedirectedDevice::set_configuration(std::uint64_t id, std::uint8_t number) {
  usb_redir_set_configuration_header header{number};
  usbredirparser_send_set_configuration(parser_.get(), id, &header);
  flush();
}

void RedirectedDevice::get_alt_setting(std::uint64_t id) {
  usb_redir_get_alt_setting_header header{0};
  usbredirparser_send_get_alt_setting(parser_.get(), id, &header);
  flush();
}

void RedirectedDevice::reset() {
  usbredirparser_send_reset(parser_.get());
  flush();
}

void RedirectedDevice::send_raw(std::span<const std::byte> bytes) {
  (void)::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

}  // namespace sonoloft::test
