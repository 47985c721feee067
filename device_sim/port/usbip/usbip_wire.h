#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "device_sim/port/usb/descriptors.h"
#include "device_sim/port/usb/urb.h"

// USB/IP 1.1.1, as the Linux kernel speaks it (Documentation/usb/usbip_protocol.rst). All numbers big-endian.

namespace sonoloft::device_sim::usbip {

inline constexpr std::uint16_t kTcpPort = 3240;
inline constexpr std::string_view kBusId = "1-1";  ///< by which a host names the one device that is exported

enum class ImportStatus : std::uint32_t { ok = 0, busy = 2, no_device = 4 };

struct DeviceListRequest {};
struct ImportRequest {
  bool our_device;
};
struct SubmitCommand {
  usb::Urb urb;  ///< id: its sequence number
};
struct UnlinkCommand {
  std::uint32_t seqnum;    ///< of this command
  std::uint32_t unlinked;  ///< of the URB
};
using Message = std::variant<DeviceListRequest, ImportRequest, SubmitCommand, UnlinkCommand>;

/// How far one message reaches into received bytes.
struct Parsed {
  enum class Kind : std::uint8_t { message, incomplete, nonsense } kind;
  std::size_t size = 0;            ///< of the message
  std::optional<Message> message;  ///< iff kind is message
};

/// The next message of a connection. Before the import only requests make sense, after it only commands.
/// Nothing is allocated beyond what was received.
[[nodiscard]] Parsed parse(std::span<const std::byte> bytes, bool imported);

/// Replies, appended to `out`.
void append_device_list(const usb::Descriptors& descriptors, std::vector<std::byte>& out);
void append_import(ImportStatus status, const usb::Descriptors& descriptors, std::vector<std::byte>& out);
void append_submit(const usb::UrbDone& done, std::vector<std::byte>& out);
/// @param cancelled  false: it had completed before
void append_unlink(std::uint32_t seqnum, bool cancelled, std::vector<std::byte>& out);

}  // namespace sonoloft::device_sim::usbip
