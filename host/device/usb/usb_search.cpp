#include "host/device/usb/usb_search.h"

#include <array>
#include <utility>
#include <vector>

#include "host/device/usb/usb_devices.h"
#include "host/device/usb/usb_error.h"

namespace sonoloft::device {
namespace {

Result<FoundProbe> open_probe(const std::shared_ptr<UsbContext>& context, libusb_device* device,
                              const UsbInterface& interface) {
  auto handle = UsbHandle::open(context, device, interface);
  if (!handle) return tl::unexpected<Error>(handle.error());
  auto serial = (*handle)->serial();
  if (!serial) return tl::unexpected<Error>(serial.error());
  return FoundProbe{std::move(*handle), std::move(*serial)};
}

}  // namespace

Result<void> each_probe(const UsbContext& context,
                        const std::function<bool(libusb_device*, const UsbInterface&)>& visit) {
  libusb_device** devices = nullptr;
  const auto count = libusb_get_device_list(context.libusb(), &devices);
  if (count < 0) return usb_error(static_cast<int>(count), "the USB devices cannot be listed");
  bool on = true;
  for (ssize_t i = 0; i < count && on; ++i) {
    if (const auto interface = find_interface(devices[i])) on = visit(devices[i], *interface);
  }
  libusb_free_device_list(devices, 1);
  return {};
}

std::string location(libusb_device* device) {
  constexpr int kMaxDepth = 7;
  std::array<std::uint8_t, kMaxDepth> ports;
  const int depth = libusb_get_port_numbers(device, ports.data(), kMaxDepth);
  std::string text = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < depth; ++i) {
    text += i == 0 ? '-' : '.';
    text += std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return text;
}

int speed_mbit(libusb_device* device) {
  switch (libusb_get_device_speed(device)) {
    case LIBUSB_SPEED_LOW:
      return 1;
    case LIBUSB_SPEED_FULL:
      return 12;
    case LIBUSB_SPEED_HIGH:
      return 480;
    case LIBUSB_SPEED_SUPER:
      return 5000;
    case LIBUSB_SPEED_SUPER_PLUS:
      return 10000;
    default:
      return 0;
  }
}

Result<FoundProbe> find_probe(std::string_view serial) {
  const auto context = UsbContext::get();
  if (!context) return tl::unexpected<Error>(context.error());
  std::vector<FoundProbe> found;
  std::optional<Error> problem;
  const auto listed = each_probe(**context, [&](libusb_device* device, const UsbInterface& interface) {
    auto probe = open_probe(*context, device, interface);
    if (!probe) {
      problem = probe.error();
    } else if (serial.empty() || probe->serial == serial) {
      found.push_back(std::move(*probe));
    }
    return true;
  });
  if (!listed) return tl::unexpected<Error>(listed.error());
  if (found.size() == 1) return std::move(found[0]);
  if (found.size() > 1) {
    return fail(ErrorCode::device_not_found,
                std::to_string(found.size()) + " USB probes are plugged in: name one by its serial number");
  }
  if (problem) return tl::unexpected<Error>(*problem);
  const std::string which = serial.empty() ? std::string() : std::string(" ").append(serial);
  return fail(ErrorCode::device_not_found, "there is no USB probe" + which + ": plug it in");
}

Result<std::vector<UsbDeviceInfo>> list_usb_devices() {
  const auto context = UsbContext::get();
  if (!context) return tl::unexpected<Error>(context.error());
  std::vector<UsbDeviceInfo> all;
  const auto listed = each_probe(**context, [&](libusb_device* device, const UsbInterface& interface) {
    libusb_device_descriptor of_device;
    libusb_get_device_descriptor(device, &of_device);
    const protocol::Version version{static_cast<std::uint8_t>(of_device.bcdDevice >> 8),
                                    static_cast<std::uint8_t>(of_device.bcdDevice & 0xFF)};
    all.push_back({location(device), {}, speed_mbit(device), version, {}});
    auto probe = open_probe(*context, device, interface);
    if (probe) {
      all.back().serial = std::move(probe->serial);
    } else {
      all.back().problem = probe.error();
    }
    return true;
  });
  if (!listed) return tl::unexpected<Error>(listed.error());
  return all;
}

}  // namespace sonoloft::device
