// What probes are plugged in?
#include <cstdio>

#include "host/device/usb/usb_devices.h"

int main() {
  const auto probes = sonoloft::device::list_usb_devices();
  if (!probes) {
    std::fprintf(stderr, "%s\n", probes.error().message.c_str());
    return 1;
  }
  std::printf("%zu probes\n", probes->size());
  for (const sonoloft::device::UsbDeviceInfo& probe : *probes)
    std::printf("%s at %s: %s\n", probe.serial.c_str(), probe.location.c_str(),
                probe.problem ? probe.problem->message.c_str() : "ready");
}
