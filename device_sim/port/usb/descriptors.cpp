#include "device_sim/port/usb/descriptors.h"

#include <algorithm>
#include <cassert>

#include "protocol/usb.h"

namespace sonoloft::device_sim::usb {
namespace {

using protocol::usb::kDeviceVersion;
using protocol::usb::kInterfaceClass;
using protocol::usb::kInterfaceProtocol;
using protocol::usb::kInterfaceSubclass;
using protocol::usb::kProductId;
using protocol::usb::kVendorId;

enum Type : std::uint8_t {
  kDevice = 1,
  kConfig = 2,
  kString = 3,
  kInterface = 4,
  kEndpoint = 5,
  kQualifier = 6,
  kOtherSpeed = 7,
  kBos = 15,
};
enum StringIndex : std::uint8_t { kLanguages, kManufacturer, kProduct, kSerial };

constexpr std::uint16_t kUsbVersion = 0x0210;  // the first with a BOS
constexpr std::uint8_t kControlPacket = 64;
constexpr std::uint16_t kFullSpeedPacket = 64;

constexpr std::uint8_t low(std::size_t number) {
  return static_cast<std::uint8_t>(number & 0xFF);
}
constexpr std::uint8_t high(std::size_t number) {
  return static_cast<std::uint8_t>(number >> 8 & 0xFF);
}

class Bytes {
 public:
  Bytes& u8(std::initializer_list<std::uint8_t> numbers) {
    for (const auto number : numbers) bytes_.push_back(std::byte{number});
    return *this;
  }
  Bytes& u16(std::size_t number) { return u8({low(number), high(number)}); }
  Bytes& utf16(std::string_view ascii) {
    for (const char c : ascii) u16(static_cast<std::uint8_t>(c));
    return *this;
  }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

std::vector<std::byte> device() {
  return Bytes()
      .u8({18, kDevice})
      .u16(kUsbVersion)
      .u8({0, 0, 0, kControlPacket})
      .u16(kVendorId)
      .u16(kProductId)
      .u16(kDeviceVersion)
      .u8({kManufacturer, kProduct, kSerial, 1})
      .take();
}

std::vector<std::byte> qualifier() {
  return Bytes().u8({10, kQualifier}).u16(kUsbVersion).u8({0, 0, 0, kControlPacket, 1, 0}).take();
}

std::vector<std::byte> configuration(Type type, std::size_t bulk_packet) {
  constexpr std::uint8_t kBusPowered = 0x80, k500mA = 250, kBulk = 2, kInterrupt = 3;
  // Frames at full speed; at high speed 2^(n - 1) microframes: 8 ms either way.
  const std::uint8_t event_interval = bulk_packet == kFullSpeedPacket ? 8 : 7;
  return Bytes()
      .u8({9, type})
      .u16(9 + 9 + 3 * 7)
      .u8({1, kConfiguration, 0, kBusPowered, k500mA})
      .u8({9, kInterface, 0, 0, 3, kInterfaceClass, kInterfaceSubclass, kInterfaceProtocol, 0})
      .u8({7, kEndpoint, kStreamIn, kBulk})
      .u16(bulk_packet)
      .u8({0})
      .u8({7, kEndpoint, kEventIn, kInterrupt})
      .u16(kEventPacket)
      .u8({event_interval})
      .u8({7, kEndpoint, kBlobOut, kBulk})
      .u16(bulk_packet)
      .u8({0})
      .take();
}

std::vector<std::byte> string(std::string_view ascii) {
  return Bytes().u8({low(2 + 2 * ascii.size()), kString}).utf16(ascii).take();
}

// {7e3f2a4c-549b-44b6-9728-4222444e95fb}: by which Windows programs find the device.
constexpr std::string_view kInterfaceGuid = "{7e3f2a4c-549b-44b6-9728-4222444e95fb}";
constexpr std::string_view kGuidProperty = "DeviceInterfaceGUIDs";

std::vector<std::byte> microsoft_set() {
  constexpr std::size_t kSetHeader = 10, kCompatibleId = 20;
  const std::size_t name_len = 2 * (kGuidProperty.size() + 1);
  const std::size_t data_len = 2 * (kInterfaceGuid.size() + 2);  // a list: ends with two zeros
  const std::size_t property_len = 10 + name_len + data_len;
  return Bytes()
      .u16(kSetHeader)
      .u8({0, 0, 0x00, 0x00, 0x03, 0x06})  // Windows 8.1 and later
      .u16(kSetHeader + kCompatibleId + property_len)
      .u16(kCompatibleId)
      .u8({3, 0, 'W', 'I', 'N', 'U', 'S', 'B', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})
      .u16(property_len)
      .u8({4, 0, 7, 0})  // a registry property, of several strings
      .u16(name_len)
      .utf16(kGuidProperty)
      .u16(0)
      .u16(data_len)
      .utf16(kInterfaceGuid)
      .u16(0)
      .u16(0)
      .take();
}

std::vector<std::byte> bos(std::size_t microsoft_len) {
  constexpr std::uint8_t kCapability = 16, kPlatform = 5, kLen = 5 + 24 + 28;
  return Bytes()
      .u8({5, kBos})
      .u16(kLen)
      .u8({2})
      // WebUSB {3408b638-09a9-47a0-8bfd-a0768815b665}, version 1.0, no landing page
      .u8({24,   kCapability, kPlatform, 0,    0x38, 0xB6, 0x08, 0x34, 0xA9, 0x09, 0xA0, 0x47,
           0x8B, 0xFD,        0xA0,      0x76, 0x88, 0x15, 0xB6, 0x65, 0x00, 0x01, 0x00, 0x00})
      // Microsoft OS 2.0 {d8dd60df-4589-4cc7-9cd2-659d9e648a9f}
      .u8({28,   kCapability, kPlatform, 0,    0xDF, 0x60, 0xDD, 0xD8, 0x89, 0x45, 0xC7, 0x4C,
           0x9C, 0xD2,        0x65,      0x9D, 0x9E, 0x64, 0x8A, 0x9F, 0x00, 0x00, 0x03, 0x06})
      .u16(microsoft_len)
      .u8({kMsOsRequest, 0})
      .take();
}

}  // namespace

Descriptors::Descriptors(std::string_view serial) : microsoft_(microsoft_set()) {
  assert(!serial.empty() && serial.size() <= 126);
  const auto add = [&](Type type, std::uint8_t index, std::vector<std::byte> bytes) {
    entries_.push_back({static_cast<std::uint16_t>(type << 8 | index), std::move(bytes)});
  };
  add(kDevice, 0, device());
  add(kConfig, 0, configuration(kConfig, kHighSpeedPacket));
  add(kQualifier, 0, qualifier());
  add(kOtherSpeed, 0, configuration(kOtherSpeed, kFullSpeedPacket));
  add(kBos, 0, bos(microsoft_.size()));
  add(kString, kLanguages, Bytes().u8({4, kString}).u16(0x0409).take());
  add(kString, kManufacturer, string("SonoLoft"));
  add(kString, kProduct, string("Tracked ultrasound probe"));
  add(kString, kSerial, string(serial));
}

std::optional<std::span<const std::byte>> Descriptors::find(std::uint16_t value) const {
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.value == value; });
  if (entry == entries_.end()) return std::nullopt;
  return std::span<const std::byte>(entry->bytes);
}

}  // namespace sonoloft::device_sim::usb
