#pragma once
#include <cstdint>

#include "protocol/record.h"
#include "protocol/usb_ids.h"

// What the two ends agree on where the cable is USB: docs/usb.md has the whole picture.
//   request -> vendor OUT on endpoint 0, its reply <- vendor IN on endpoint 0; records <- bulk IN, one in a transfer.

namespace sonoloft::protocol::usb {

/// bcdDevice: the wire's version can be read before the device is opened.
inline constexpr std::uint16_t kDeviceVersion = kVersion.major << 8 | kVersion.minor;

/// The interface that speaks the protocol, told from others of the same vendor: class, subclass, protocol.
inline constexpr std::uint8_t kInterfaceClass = 0xFF, kInterfaceSubclass = 0x53, kInterfaceProtocol = 0x4C;

/// Vendor requests to that interface (bRequest). wValue is 0, wIndex the interface's number.
/// send: OUT, its data are a request. It takes the place of whatever was asked before.
/// reply: IN, its data are the reply to the last request; a stall where there was none. May be repeated.
inline constexpr std::uint8_t kSendRequest = 1, kReadReply = 2;

}  // namespace sonoloft::protocol::usb
