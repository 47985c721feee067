#include "device_sim/port/usbip/usbip_wire.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace sonoloft::device_sim::usbip {

using usb::Descriptors;
using usb::UrbDone;
using usb::UrbStatus;

namespace {

constexpr std::uint16_t kVersion = 0x0111;
enum Code : std::uint16_t { kReplyImport = 0x0003, kReplyList = 0x0005, kImport = 0x8003, kList = 0x8005 };
enum Command : std::uint32_t { kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4 };

constexpr std::size_t kRequestLen = 8, kPathLen = 256, kBusIdLen = 32, kCommandLen = 48;
constexpr std::uint32_t kBusNumber = 1, kDeviceNumber = 2, kHighSpeed = 3;
constexpr std::uint32_t kNoPackets = 0xFFFFFFFF;  // not isochronous
constexpr std::uint32_t kToHost = 1;
constexpr std::size_t kMaxSent = 1u << 16;  // in one transfer of a host; a request has at most 4088 bytes, a block 4096

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return number(4); }
  std::span<const std::byte> take(std::size_t count) {
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }

 private:
  std::uint32_t number(std::size_t size) {
    std::uint32_t value = 0;
    for (const std::byte b : take(size)) value = value << 8 | std::to_integer<std::uint32_t>(b);
    return value;
  }

  std::span<const std::byte> bytes_;
};

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  Writer& u8(std::uint32_t value) {
    out_.push_back(static_cast<std::byte>(value & 0xFF));
    return *this;
  }
  Writer& u16(std::uint32_t value) { return u8(value >> 8).u8(value); }
  Writer& u32(std::uint32_t value) { return u16(value >> 16).u16(value); }
  Writer& text(std::string_view text, std::size_t len) {
    for (std::size_t i = 0; i < len; ++i) u8(i < text.size() ? static_cast<std::uint8_t>(text[i]) : 0);
    return *this;
  }
  Writer& bytes(std::span<const std::byte> more) {
    out_.insert(out_.end(), more.begin(), more.end());
    return *this;
  }

 private:
  std::vector<std::byte>& out_;
};

std::uint32_t u8_of(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<std::uint32_t>(bytes[at]);
}

// struct usbip_usb_device
void append_device(const Descriptors& descriptors, Writer& out) {
  const auto device = *descriptors.find(0x0100), configuration = *descriptors.find(0x0200);
  out.text("/sys/devices/sonoloft/1-1", kPathLen).text(kBusId, kBusIdLen);
  out.u32(kBusNumber).u32(kDeviceNumber).u32(kHighSpeed);
  for (const std::size_t at : {8u, 10u, 12u})
    out.u8(u8_of(device, at + 1)).u8(u8_of(device, at));                // vendor, product, ...
  for (const std::size_t at : {4u, 5u, 6u}) out.u8(u8_of(device, at));  // class, ...
  out.u8(0).u8(u8_of(device, 17)).u8(u8_of(configuration, 4));
}

Parsed incomplete() {
  return {Parsed::Kind::incomplete, 0, {}};
}
Parsed nonsense() {
  return {Parsed::Kind::nonsense, 0, {}};
}

Parsed parse_request(std::span<const std::byte> bytes) {
  if (bytes.size() < kRequestLen) return incomplete();
  Reader in(bytes);
  const auto version = in.u16(), code = in.u16();
  (void)in.u32();  // a request's status says nothing
  // Hosts of every version up to now send the same requests.
  if (version >> 8 != kVersion >> 8) return nonsense();
  if (code == kList) return {Parsed::Kind::message, kRequestLen, DeviceListRequest{}};
  if (code != kImport) return nonsense();
  if (bytes.size() < kRequestLen + kBusIdLen) return incomplete();
  const auto id = in.take(kBusIdLen);
  const auto same = [](char c, std::byte b) { return static_cast<std::byte>(c) == b; };
  const bool ours = std::equal(kBusId.begin(), kBusId.end(), id.begin(), same) && id[kBusId.size()] == std::byte{0};
  return {Parsed::Kind::message, kRequestLen + kBusIdLen, ImportRequest{ours}};
}

Parsed parse_submit(std::uint32_t seqnum, std::uint32_t direction, std::uint32_t endpoint, Reader& in,
                    std::span<const std::byte> bytes) {
  (void)in.u32();  // flags: a message never needs a zero-length packet
  const std::uint32_t length = in.u32();
  (void)in.u32();
  const std::uint32_t packets = in.u32();
  (void)in.u32();
  const bool to_host = direction == kToHost;
  if (endpoint > 15 || direction > 1 || (packets != 0 && packets != kNoPackets)) return nonsense();
  if (length > INT32_MAX || (!to_host && length > kMaxSent)) return nonsense();
  SubmitCommand command;
  command.urb.id = seqnum;
  command.urb.endpoint = static_cast<std::uint8_t>(endpoint | (to_host && endpoint != 0 ? 0x80 : 0));
  command.urb.room = to_host ? length : 0;
  std::memcpy(&command.urb.setup, in.take(sizeof(usb::SetupPacket)).data(), sizeof(usb::SetupPacket));
  // What its setup asks for must fit into the transfer, which for nothing at all may go either way.
  const usb::SetupPacket& setup = command.urb.setup;
  if (endpoint == 0 && setup.length != 0 && (setup.to_host() != to_host || setup.length > length)) return nonsense();
  const std::size_t sent = to_host ? 0 : length;
  if (bytes.size() < kCommandLen + sent) return incomplete();
  const auto data = bytes.subspan(kCommandLen, sent);
  command.urb.data.assign(data.begin(), data.end());
  return {Parsed::Kind::message, kCommandLen + sent, std::move(command)};
}

Parsed parse_command(std::span<const std::byte> bytes) {
  if (bytes.size() < kCommandLen) return incomplete();
  Reader in(bytes);
  const auto command = in.u32(), seqnum = in.u32();
  (void)in.u32();  // the device: there is one
  const auto direction = in.u32(), endpoint = in.u32();
  if (command == kSubmit) return parse_submit(seqnum, direction, endpoint, in, bytes);
  if (command == kUnlink) return {Parsed::Kind::message, kCommandLen, UnlinkCommand{seqnum, in.u32()}};
  return nonsense();
}

std::uint32_t status_of(UrbStatus status) {
  switch (status) {
    case UrbStatus::ok:
      return 0;
    case UrbStatus::stalled:
      return static_cast<std::uint32_t>(-EPIPE);
    case UrbStatus::overflow:
      return static_cast<std::uint32_t>(-EOVERFLOW);
    case UrbStatus::gone:
      break;
  }
  return static_cast<std::uint32_t>(-ENODEV);
}

}  // namespace

Parsed parse(std::span<const std::byte> bytes, bool imported) {
  return imported ? parse_command(bytes) : parse_request(bytes);
}

void append_device_list(const Descriptors& descriptors, std::vector<std::byte>& out) {
  constexpr std::size_t kFirstInterface = 9;  // in the configuration
  const auto configuration = *descriptors.find(0x0200);
  Writer writer(out);
  writer.u16(kVersion).u16(kReplyList).u32(0).u32(1);
  append_device(descriptors, writer);
  for (const std::size_t at : {5u, 6u, 7u}) writer.u8(u8_of(configuration, kFirstInterface + at));
  writer.u8(0);
}

void append_import(ImportStatus status, const Descriptors& descriptors, std::vector<std::byte>& out) {
  Writer writer(out);
  writer.u16(kVersion).u16(kReplyImport).u32(static_cast<std::uint32_t>(status));
  if (status == ImportStatus::ok) append_device(descriptors, writer);
}

void append_submit(const UrbDone& done, std::vector<std::byte>& out) {
  Writer writer(out);
  writer.u32(kSubmitted).u32(static_cast<std::uint32_t>(done.id)).u32(0).u32(0).u32(0);
  writer.u32(status_of(done.status)).u32(static_cast<std::uint32_t>(done.size)).u32(0).u32(kNoPackets).u32(0);
  writer.u32(0).u32(0).bytes(done.data);
}

void append_unlink(std::uint32_t seqnum, bool cancelled, std::vector<std::byte>& out) {
  Writer writer(out);
  writer.u32(kUnlinked).u32(seqnum).u32(0).u32(0).u32(0);
  writer.u32(cancelled ? static_cast<std::uint32_t>(-ECONNRESET) : 0);
  for (int i = 0; i < 6; ++i) writer.u32(0);
}

}  // namespace sonoloft::device_sim::usbip
