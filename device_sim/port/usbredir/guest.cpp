#include "device_sim/port/usbredir/guest.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <span>
#include <utility>

namespace sonoloft::device_sim::usbredir {

using usb::UrbStatus;

namespace {

constexpr int kReadLen = 1 << 16;
constexpr std::size_t kMaxPending = 4096;       // transfers; QEMU has at most some dozens under way
constexpr std::uint64_t kMaxUnsent = 1u << 22;  // bytes
constexpr std::uint64_t kNextEventId = ~std::uint64_t{0};
constexpr std::uint8_t kNumber = 0x0F, kIn = 0x80;  // of an endpoint's address

// Where usb_redir_ep_info keeps what it says of an endpoint.
constexpr std::size_t slot(std::uint8_t endpoint) {
  return (endpoint & kIn) / 8u + (endpoint & kNumber);
}

std::uint8_t u8(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint8_t>(bytes[at]);
}
std::uint16_t u16(std::span<const std::byte> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(u8(bytes, at) | u8(bytes, at + 1) << 8);
}

std::uint8_t status_of(UrbStatus status) {
  switch (status) {
    case UrbStatus::ok:
      return usb_redir_success;
    case UrbStatus::stalled:
      return usb_redir_stall;
    case UrbStatus::overflow:
      return usb_redir_babble;
    case UrbStatus::gone:
      break;
  }
  return usb_redir_ioerror;
}

}  // namespace

Guest::Guest(int socket, usb::UsbDevice& device) : socket_(socket), device_(device), parser_(usbredirparser_create()) {
  parser_->priv = this;
  set_callbacks();
  std::uint32_t capabilities[USB_REDIR_CAPS_SIZE] = {};
  for (const int capability : {usb_redir_cap_connect_device_version, usb_redir_cap_ep_info_max_packet_size,
                               usb_redir_cap_64bits_ids, usb_redir_cap_32bits_bulk_length}) {
    usbredirparser_caps_set_cap(capabilities, capability);
  }
  usbredirparser_init(parser_.get(), "SonoLoft", capabilities, USB_REDIR_CAPS_SIZE, usbredirparser_fl_usb_host);
}

Guest::~Guest() {
  device_.reset();
  close(socket_);
}

short Guest::awaited() const {
  const bool listens = usbredirparser_get_bufferered_output_size(parser_.get()) < kMaxUnsent;
  const bool speaks = usbredirparser_has_data_to_write(parser_.get()) != 0 || unplugged_;
  return static_cast<short>((listens ? POLLIN : 0) | (speaks ? POLLOUT : 0));
}

bool Guest::receive() {
  budget_ = kReadLen;
  return usbredirparser_do_read(parser_.get()) == 0 && !nonsense_;
}

bool Guest::send() {
  const bool sent = usbredirparser_do_write(parser_.get()) == 0;
  const bool all = usbredirparser_has_data_to_write(parser_.get()) == 0;
  return (sent || errno == EAGAIN || errno == EINTR) && !(all && unplugged_);
}

// ---- what the guest asks

void Guest::plug_in() {
  const auto device = *device_.descriptors().find(0x0100);
  send_interface();
  usb_redir_device_connect_header header{};
  header.speed = usb_redir_speed_high;
  header.device_class = u8(device, 4);
  header.device_subclass = u8(device, 5);
  header.device_protocol = u8(device, 6);
  header.vendor_id = u16(device, 8);
  header.product_id = u16(device, 10);
  header.device_version_bcd = u16(device, 12);
  usbredirparser_send_device_connect(parser_.get(), &header);
}

void Guest::send_interface() {
  constexpr std::size_t kFirstInterface = 9, kEventInterval = 9 + 9 + 7 + 6;  // in the configuration
  const auto interface = device_.descriptors().find(0x0200)->subspan(kFirstInterface);
  usb_redir_interface_info_header info{};
  info.interface_count = 1;
  info.interface_class[0] = u8(interface, 5);
  info.interface_subclass[0] = u8(interface, 6);
  info.interface_protocol[0] = u8(interface, 7);
  usbredirparser_send_interface_info(parser_.get(), &info);

  usb_redir_ep_info_header endpoints{};
  std::fill(std::begin(endpoints.type), std::end(endpoints.type), std::uint8_t{usb_redir_type_invalid});
  endpoints.type[slot(0)] = endpoints.type[slot(kIn)] = usb_redir_type_control;
  for (const auto bulk : {usb::kStreamIn, usb::kBlobOut}) {
    endpoints.type[slot(bulk)] = usb_redir_type_bulk;
    endpoints.max_packet_size[slot(bulk)] = usb::kHighSpeedPacket;
  }
  endpoints.type[slot(usb::kEventIn)] = usb_redir_type_interrupt;
  endpoints.max_packet_size[slot(usb::kEventIn)] = usb::kEventPacket;
  endpoints.interval[slot(usb::kEventIn)] = u8(*device_.descriptors().find(0x0200), kEventInterval);
  usbredirparser_send_ep_info(parser_.get(), &endpoints);
}

void Guest::reset() {
  receives_events_ = false;
  const auto asked = std::exchange(pending_, {});
  for (const auto& [id, question] : asked) {
    // What was not under way any more is answered when its completion comes.
    if (device_.unlink(id)) {
      reply(question, {id, UrbStatus::ok, {}, 0}, usb_redir_cancelled);
    } else {
      pending_.emplace(id, question);
    }
  }
  device_.reset();
}

void Guest::cancel(std::uint64_t id) {
  const auto asked = pending_.find(id);
  if (asked == pending_.end() || !device_.unlink(id)) return;  // it was, or will be, answered
  reply(asked->second, {id, UrbStatus::ok, {}, 0}, usb_redir_cancelled);
  pending_.erase(asked);
}

void Guest::start_events(std::uint64_t id, std::uint8_t endpoint) {
  const bool ours = endpoint == usb::kEventIn;
  if (ours && !std::exchange(receives_events_, true)) await_event();
  usb_redir_interrupt_receiving_status_header header{
      static_cast<std::uint8_t>(ours ? usb_redir_success : usb_redir_inval), endpoint};
  usbredirparser_send_interrupt_receiving_status(parser_.get(), id, &header);
}

void Guest::stop_events(std::uint64_t id, std::uint8_t endpoint) {
  receives_events_ = false;
  if (device_.unlink(kNextEventId)) pending_.erase(kNextEventId);
  usb_redir_interrupt_receiving_status_header header{usb_redir_success, endpoint};
  usbredirparser_send_interrupt_receiving_status(parser_.get(), id, &header);
}

// At most one is asked for: while one still waits from before, that one will do.
void Guest::await_event() {
  if (!pending_.emplace(kNextEventId, NextEvent{}).second) return;
  device_.submit({.id = kNextEventId, .endpoint = usb::kEventIn, .room = usb::kEventPacket});
}

void Guest::ask_control(std::uint64_t id, const ControlPacket& header, std::vector<std::byte> data) {
  const bool sensible = (header.endpoint & kNumber) == 0 && (header.endpoint & kIn) == (header.requesttype & kIn);
  const usb::SetupPacket setup{header.requesttype, header.request, header.value, header.index, header.length};
  ask(id, header, {.id = id, .endpoint = 0, .setup = setup, .data = std::move(data), .room = header.length}, sensible);
}

void Guest::ask_bulk(std::uint64_t id, const BulkPacket& header, std::vector<std::byte> data) {
  // Of a peer that does not know the upper half the parser leaves in it what was there.
  const bool long_ones = usbredirparser_peer_has_cap(parser_.get(), usb_redir_cap_32bits_bulk_length) != 0;
  const std::size_t room = (long_ones ? header.length_high * 0x10000u : 0) + header.length;
  ask(id, header, {.id = id, .endpoint = header.endpoint, .data = std::move(data), .room = room},
      (header.endpoint & kNumber) != 0);
}

void Guest::ask_device(std::uint64_t id, const Question& question, usb::SetupPacket setup) {
  ask(id, question, {.id = id, .endpoint = 0, .setup = setup, .room = setup.length}, true);
}

void Guest::ask(std::uint64_t id, const Question& question, usb::Urb urb, bool sensible) {
  const bool greeted = usbredirparser_have_peer_caps(parser_.get()) != 0;
  if (!sensible || !greeted || pending_.size() == kMaxPending || !pending_.emplace(id, question).second) {
    nonsense_ = true;
    return;
  }
  device_.submit(std::move(urb));
}

// ---- what it is answered

void Guest::answer(const usb::Completion& done) {
  const auto asked = pending_.find(done.id);
  assert(asked != pending_.end());
  const Question question = asked->second;
  pending_.erase(asked);
  reply(question, done, status_of(done.status));
  if (done.status != UrbStatus::gone || std::exchange(unplugged_, true)) return;
  usbredirparser_send_device_disconnect(parser_.get());
}

void Guest::answer_event(const usb::Completion& done) {
  if (!receives_events_) return;
  auto* const data = reinterpret_cast<std::uint8_t*>(const_cast<std::byte*>(done.data.data()));
  if (done.status == UrbStatus::ok) {
    usb_redir_interrupt_packet_header header{usb::kEventIn, usb_redir_success,
                                             static_cast<std::uint16_t>(done.data.size())};
    usbredirparser_send_interrupt_packet(parser_.get(), events_sent_++, &header, data,
                                         static_cast<int>(done.data.size()));
    return await_event();
  }
  receives_events_ = false;
  usb_redir_interrupt_receiving_status_header header{status_of(done.status), usb::kEventIn};
  usbredirparser_send_interrupt_receiving_status(parser_.get(), 0, &header);
}

void Guest::reply(const Question& question, const usb::Completion& done, std::uint8_t status) {
  usbredirparser* const p = parser_.get();
  auto* const data = reinterpret_cast<std::uint8_t*>(const_cast<std::byte*>(done.data.data()));
  const int len = static_cast<int>(done.data.size());
  const auto size = static_cast<std::uint16_t>(done.size & 0xFFFF);
  if (const auto* control = std::get_if<ControlPacket>(&question)) {
    ControlPacket header = *control;
    header.status = status;
    header.length = size;
    usbredirparser_send_control_packet(p, done.id, &header, data, len);
  } else if (const auto* bulk = std::get_if<BulkPacket>(&question)) {
    BulkPacket header = *bulk;
    header.status = status;
    header.length = size;
    header.length_high = static_cast<std::uint16_t>(done.size >> 16);
    usbredirparser_send_bulk_packet(p, done.id, &header, data, len);
  } else if (const auto* configuration = std::get_if<Configuration>(&question)) {
    usb_redir_configuration_status_header header{status, len == 0 ? configuration->number : *data};
    send_interface();
    usbredirparser_send_configuration_status(p, done.id, &header);
  } else if (const auto* setting = std::get_if<AltSetting>(&question)) {
    usb_redir_alt_setting_status_header header{status, setting->interface, len == 0 ? setting->number : *data};
    send_interface();
    usbredirparser_send_alt_setting_status(p, done.id, &header);
  } else if (status != usb_redir_cancelled) {
    answer_event(done);
  }
}

}  // namespace sonoloft::device_sim::usbredir
