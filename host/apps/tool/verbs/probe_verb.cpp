#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "device_sim/port/functionfs/function_words.h"
#include "device_sim/port/functionfs/functionfs_device.h"
#include "device_sim/port/usbip/usbip_server.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/phantom/body.h"
#include "host/apps/tool/phantom/simulated_probe_options.h"
#include "host/apps/tool/verbs/verbs.h"

#ifdef SONOLOFT_WITH_USBREDIR
#include "device_sim/port/usbredir/usbredir_server.h"
#endif

namespace sonoloft::tool {
namespace {

constexpr std::uint16_t kUsbredirPort = 4000;

struct ProbeOptions {
  SimulatedProbeOptions simulated;
  bool usbip = false, usbredir = false;
  std::optional<std::uint16_t> tcp_port;
  std::string functionfs;  ///< where it is mounted
};

/// A way to the probe, open while it lives.
struct Way {
  std::shared_ptr<void> server;
  std::string said;  ///< what it is, and how it is used
};

Result<Way> serve_usbip(SimulatedScan& device, std::uint16_t tcp_port) {
  auto server = device_sim::usbip::UsbipServer::start(device.port(), device.usb_identity(), tcp_port);
  if (!server.value) return fail(ErrorCode::io_failed, server.error);
  const std::string port = std::to_string(server.value->tcp_port());
  return Way{std::move(server.value),
             "USB/IP on TCP port " + port +
                 "; plug it in as root, until Ctrl-C:\n  modprobe vhci-hcd && usbip --tcp-port " + port +
                 " attach -r 127.0.0.1 -b " + std::string(device_sim::usbip::kBusId)};
}

#ifdef SONOLOFT_WITH_USBREDIR
Result<Way> serve_usbredir(SimulatedScan& device, std::uint16_t tcp_port) {
  auto server = device_sim::usbredir::UsbredirServer::start(device.port(), device.usb_identity(), tcp_port);
  if (!server.value) return fail(ErrorCode::io_failed, server.error);
  const std::string port = std::to_string(server.value->tcp_port());
  return Way{std::move(server.value),
             "USB redirection on TCP port " + port + "; plug it into a virtual machine, until Ctrl-C:\n" +
                 "  qemu-system-x86_64 ... -device qemu-xhci -chardev socket,id=probe,host=127.0.0.1,port=" + port +
                 ",reconnect=1 -device usb-redir,chardev=probe"};
}
#else
Result<Way> serve_usbredir(SimulatedScan&, std::uint16_t) {
  return fail(ErrorCode::not_available,
              "--usbredir is not built in: install libusbredirparser (Debian: libusbredirparser-dev) and build again");
}
#endif

Result<Way> serve_functionfs(SimulatedScan& device, const std::string& directory) {
  auto function = device_sim::functionfs::FunctionfsDevice::start(device.port(), device.usb_identity(), directory);
  if (!function.value) return fail(ErrorCode::io_failed, function.error);
  std::string said = "a function in " + directory + "; for the gadget around it, until Ctrl-C:";
  for (const auto& [name, value] : device_sim::functionfs::gadget_attributes(function.value->descriptors())) {
    said += "\n  " + name + " " + value;
  }
  return Way{std::move(function.value), std::move(said)};
}

Result<Way> serve(SimulatedScan& device, const ProbeOptions& options) {
  if (!options.functionfs.empty()) return serve_functionfs(device, options.functionfs);
  if (options.usbredir) return serve_usbredir(device, options.tcp_port.value_or(kUsbredirPort));
  return serve_usbip(device, options.tcp_port.value_or(device_sim::usbip::kTcpPort));
}

Result<void> run_probe(const ProbeOptions& options) {
  const auto body = load_body(options.simulated.phantom, options.simulated.data);
  if (!body) return tl::unexpected<Error>(body.error());
  const auto device = SimulatedScan::make(*body, options.simulated.plan);
  if (!device) return tl::unexpected<Error>(device.error());
  const auto way = serve(**device, options);
  if (!way) return tl::unexpected<Error>(way.error());
  note_interrupts();
  std::cout << "probe " << (*device)->usb_identity().serial << ", " << (*device)->slices() << " slices of "
            << options.simulated.phantom << ", " << way->said << std::endl;
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return {};
}

}  // namespace

void add_probe(CLI::App& app, Task& task) {
  auto* verb =
      app.add_subcommand("probe", "Is a simulated probe that other programs, or another machine's kernel, use");
  auto options = std::make_shared<ProbeOptions>();
  auto* way = verb->add_option_group("Way", "How it is reached as a USB device")->require_option(1);
  way->add_flag("--usbip", options->usbip, "By USB/IP, from this machine's kernel; on 127.0.0.1 only");
  way->add_flag("--usbredir", options->usbredir, "By USB redirection, from QEMU; on 127.0.0.1 only");
  auto* functionfs =
      way->add_option("--functionfs", options->functionfs, "By this machine's device controller; a mounted functionfs");
  verb->add_option("--port", options->tcp_port, "TCP port; 0: any that is free; default: 3240, with --usbredir 4000")
      ->excludes(functionfs);
  add_simulated_probe(*verb, options->simulated);
  verb->callback([&task, options] { task = [options] { return run_probe(*options); }; });
}

}  // namespace sonoloft::tool
