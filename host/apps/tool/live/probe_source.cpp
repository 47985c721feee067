#include "host/apps/tool/live/probe_source.h"

#include <iostream>
#include <utility>

#include "host/device/loopback/loopback_transport.h"
#include "host/device/usb/usb_transport.h"

namespace sonoloft::tool {
namespace {

Result<OpenedProbe> open_usb(const std::string& serial) {
  auto transport = device::UsbTransport::open(serial);
  if (!transport) return tl::unexpected<Error>(transport.error());
  std::cout << "probe " << (*transport)->serial() << ", USB at " << (*transport)->speed_mbit() << " Mbit/s\n";
  return OpenedProbe{nullptr, std::move(*transport)};
}

Result<OpenedProbe> open_simulated(const SimulatedProbeOptions& probe) {
  const auto body = load_body(probe.phantom, probe.data);
  if (!body) return tl::unexpected<Error>(body.error());
  auto simulated = SimulatedScan::make(*body, probe.plan);
  if (!simulated) return tl::unexpected<Error>(simulated.error());
  auto transport = std::make_unique<device::LoopbackTransport>((*simulated)->port());
  return OpenedProbe{std::move(*simulated), std::move(transport)};
}

}  // namespace

void add_probe_source(CLI::App& verb, ProbeSource& source) {
  verb.add_option("--serial", source.serial, "The probe; default: the only one that is plugged in");
  verb.add_flag("--simulated", source.simulated, "A simulated probe in this program instead of one on USB");
  add_simulated_probe(verb, source.probe);
}

Result<OpenedProbe> open_probe(const ProbeSource& source) {
  return source.simulated ? open_simulated(source.probe) : open_usb(source.serial);
}

}  // namespace sonoloft::tool
