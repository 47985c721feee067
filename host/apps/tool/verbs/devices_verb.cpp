#include <iostream>

#include "host/apps/tool/verbs/verbs.h"
#include "host/device/session.h"
#include "host/device/usb/usb_devices.h"
#include "host/device/usb/usb_transport.h"

namespace sonoloft::tool {
namespace {

std::string speed_text(int mbit) {
  return mbit == 0 ? "unknown speed" : std::to_string(mbit) + " Mbit/s";
}

std::string text(protocol::Version v) {
  return std::to_string(v.major) + "." + std::to_string(v.minor);
}

/// What only an opened device tells.
std::string firmware_of(const device::UsbDeviceInfo& probe) {
  auto transport = device::UsbTransport::open(probe.serial);
  if (!transport) return transport.error().message;
  const auto session = device::Session::open(std::move(*transport));
  if (!session) return session.error().message;
  return "firmware " + (*session)->info().firmware_version;
}

Result<void> list_devices() {
  const auto probes = device::list_usb_devices();
  if (!probes) return tl::unexpected<Error>(probes.error());
  for (const device::UsbDeviceInfo& probe : *probes) {
    std::cout << (probe.serial.empty() ? "?" : probe.serial) << "  USB " << probe.location << "  "
              << speed_text(probe.speed_mbit) << "  protocol " << text(probe.version) << "  "
              << (probe.problem ? probe.problem->message : firmware_of(probe)) << '\n';
  }
  if (probes->empty()) std::cout << "no probe is plugged in; sonoloft probe --usbip simulates one\n";
  return {};
}

}  // namespace

void add_devices(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("devices", "Lists the probes on USB, with serial number, speed and versions");
  verb->callback([&task] { task = list_devices; });
}

}  // namespace sonoloft::tool
