#include <chrono>
#include <iostream>
#include <memory>
#include <thread>

#include "device_sim/port/usbip/usbip_server.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/phantom/body.h"
#include "host/apps/tool/phantom/simulated_probe_options.h"
#include "host/apps/tool/verbs/verbs.h"

namespace sonoloft::tool {
namespace {

using device_sim::usbip::UsbipServer;

struct ProbeOptions {
  SimulatedProbeOptions simulated;
  bool usbip = false;  ///< the one way there is
  std::uint16_t tcp_port = device_sim::usbip::kTcpPort;
};

Result<void> run_probe(const ProbeOptions& options) {
  const auto body = load_body(options.simulated.phantom, options.simulated.data);
  if (!body) return tl::unexpected<Error>(body.error());
  const auto device = SimulatedScan::make(*body, options.simulated.plan);
  if (!device) return tl::unexpected<Error>(device.error());
  const auto server = UsbipServer::start((*device)->port(), (*device)->usb_identity(), options.tcp_port);
  if (!server.value) return fail(ErrorCode::io_failed, server.error);
  note_interrupts();
  std::cout << "probe " << (*device)->usb_identity().serial << ", " << (*device)->slices() << " slices of "
            << options.simulated.phantom << ", USB/IP on TCP port " << server.value->tcp_port()
            << "; plug it in as root, until Ctrl-C:\n"
            << "  modprobe vhci-hcd && usbip --tcp-port " << server.value->tcp_port() << " attach -r 127.0.0.1 -b "
            << device_sim::usbip::kBusId << std::endl;
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return {};
}

}  // namespace

void add_probe(CLI::App& app, Task& task) {
  auto* verb =
      app.add_subcommand("probe", "Is a simulated probe that other programs, or another machine's kernel, use");
  auto options = std::make_shared<ProbeOptions>();
  verb->add_flag("--usbip", options->usbip, "As a USB device, by USB/IP; on 127.0.0.1 only")->required();
  verb->add_option("--port", options->tcp_port, "TCP port; 0: any that is free")->capture_default_str();
  add_simulated_probe(*verb, options->simulated);
  verb->callback([&task, options] { task = [options] { return run_probe(*options); }; });
}

}  // namespace sonoloft::tool
