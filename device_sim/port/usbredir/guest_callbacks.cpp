// What libusbredirparser calls, and what it reads with.
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <span>

#include "device_sim/port/usbredir/guest.h"

namespace sonoloft::device_sim::usbredir {
namespace {

constexpr std::uint8_t kToDevice = 0, kToInterface = 1, kIn = 0x80;
constexpr std::uint8_t kGetConfiguration = 8, kSetConfiguration = 9, kGetInterface = 10, kSetInterface = 11;

}  // namespace

void Guest::set_callbacks() {
  usbredirparser& p = *parser_;
  p.log_func = [](void*, int, const char*) {};  // what is wrong with a guest ends its connection
  p.read_func = [](void* self, std::uint8_t* data, int count) { return static_cast<Guest*>(self)->read(data, count); };
  p.write_func = [](void* self, std::uint8_t* data, int count) {
    const auto size = static_cast<std::size_t>(count);
    return static_cast<int>(::send(static_cast<Guest*>(self)->socket_, data, size, MSG_NOSIGNAL));
  };
  p.hello_func = [](void* self, usb_redir_hello_header*) { static_cast<Guest*>(self)->plug_in(); };
  p.reset_func = [](void* self) { static_cast<Guest*>(self)->reset(); };
  p.cancel_data_packet_func = [](void* self, std::uint64_t id) { static_cast<Guest*>(self)->cancel(id); };
  p.set_configuration_func = [](void* self, std::uint64_t id, usb_redir_set_configuration_header* header) {
    const std::uint8_t number = header->configuration;
    static_cast<Guest*>(self)->ask_device(id, Configuration{number}, {kToDevice, kSetConfiguration, number, 0, 0});
  };
  p.get_configuration_func = [](void* self, std::uint64_t id) {
    static_cast<Guest*>(self)->ask_device(id, Configuration{0}, {kToDevice | kIn, kGetConfiguration, 0, 0, 1});
  };
  p.set_alt_setting_func = [](void* self, std::uint64_t id, usb_redir_set_alt_setting_header* header) {
    const AltSetting asked{header->interface, header->alt};
    static_cast<Guest*>(self)->ask_device(id, asked, {kToInterface, kSetInterface, asked.number, asked.interface, 0});
  };
  p.get_alt_setting_func = [](void* self, std::uint64_t id, usb_redir_get_alt_setting_header* header) {
    const AltSetting asked{header->interface, 0};
    static_cast<Guest*>(self)->ask_device(id, asked, {kToInterface | kIn, kGetInterface, 0, asked.interface, 1});
  };
  p.start_interrupt_receiving_func = [](void* self, std::uint64_t id,
                                        usb_redir_start_interrupt_receiving_header* header) {
    static_cast<Guest*>(self)->start_events(id, header->endpoint);
  };
  p.stop_interrupt_receiving_func = [](void* self, std::uint64_t id,
                                       usb_redir_stop_interrupt_receiving_header* header) {
    static_cast<Guest*>(self)->stop_events(id, header->endpoint);
  };
  set_data_callbacks();
  refuse_the_rest();
}

void Guest::set_data_callbacks() {
  usbredirparser& p = *parser_;
  p.control_packet_func = [](void* self, std::uint64_t id, ControlPacket* header, std::uint8_t* data, int len) {
    static_cast<Guest*>(self)->ask_control(id, *header, static_cast<Guest*>(self)->take(data, len));
  };
  p.bulk_packet_func = [](void* self, std::uint64_t id, BulkPacket* header, std::uint8_t* data, int len) {
    static_cast<Guest*>(self)->ask_bulk(id, *header, static_cast<Guest*>(self)->take(data, len));
  };
  const auto refuse_data = [](void* self, std::uint64_t, auto*, std::uint8_t* data, int len) {
    (void)static_cast<Guest*>(self)->take(data, len);
    static_cast<Guest*>(self)->nonsense_ = true;
  };
  p.iso_packet_func = refuse_data;
  p.interrupt_packet_func = refuse_data;
}

// The parser calls what is not set, too.
void Guest::refuse_the_rest() {
  usbredirparser& p = *parser_;
  const auto refuse = [](void* self, auto...) { static_cast<Guest*>(self)->nonsense_ = true; };
  p.start_iso_stream_func = refuse;
  p.stop_iso_stream_func = refuse;
  p.start_bulk_receiving_func = refuse;
  p.stop_bulk_receiving_func = refuse;
  p.alloc_bulk_streams_func = refuse;
  p.free_bulk_streams_func = refuse;
  p.filter_reject_func = refuse;
  p.filter_filter_func = refuse;
  p.device_disconnect_ack_func = refuse;
}

int Guest::read(std::uint8_t* data, int count) {
  const int most = std::min(count, budget_);
  if (most == 0) return 0;
  const ssize_t size = recv(socket_, data, static_cast<std::size_t>(most), 0);
  if (size > 0) budget_ -= static_cast<int>(size);
  if (size > 0) return static_cast<int>(size);
  return size < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

std::vector<std::byte> Guest::take(std::uint8_t* data, int len) {
  const auto bytes = std::as_bytes(std::span(data, static_cast<std::size_t>(len)));
  std::vector<std::byte> taken(bytes.begin(), bytes.end());
  usbredirparser_free_packet_data(parser_.get(), data);
  return taken;
}

}  // namespace sonoloft::device_sim::usbredir
