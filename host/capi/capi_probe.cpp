// How C reaches devices.
#include "host/capi/capi_probe.h"

#include <utility>

#include "host/capi/capi_status.h"
#include "host/device/usb/usb_devices.h"
#include "host/device/usb/usb_monitor.h"
#include "host/device/usb/usb_transport.h"
#include "host/simulated/simulated_probe.h"

using namespace sonoloft;
using namespace sonoloft::capi;

struct sonoloft_usb_watch {
  std::unique_ptr<device::UsbMonitor> monitor;
};

namespace {

Result<SimulatedProbeOptions> simulation_of(const sonoloft_simulation* given) {
  const auto read = read_sized(given);
  if (!read) return tl::unexpected<Error>(read.error());
  if (read->phantom != SONOLOFT_ORGANS && read->phantom != SONOLOFT_TORSO)
    return fail(ErrorCode::invalid_argument, "there is no such phantom: give one of sonoloft_phantom");
  SimulatedProbeOptions options;
  options.phantom = read->phantom == SONOLOFT_TORSO ? SimulatedPhantom::torso : SimulatedPhantom::organs;
  if (read->slices != 0) options.slices = read->slices;
  if (read->seed != 0) options.seed = read->seed;
  options.rate_hz = read->rate_hz;
  return options;
}

template <class T>
Result<void> hand_over(Result<std::unique_ptr<T>> transport, sonoloft_probe** probe) {
  if (!transport) return tl::unexpected<Error>(transport.error());
  *probe = new sonoloft_probe{std::move(*transport)};
  return {};
}

}  // namespace

sonoloft_status sonoloft_list_usb(void (*visit)(void*, const sonoloft_usb_device*), void* user, sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(visit); !given) return given;
    const auto devices = device::list_usb_devices();
    if (!devices) return tl::unexpected<Error>(devices.error());
    for (const device::UsbDeviceInfo& d : *devices) {
      const auto status = d.problem ? static_cast<sonoloft_status>(d.problem->code) : SONOLOFT_OK;
      const sonoloft_usb_device device{d.serial.c_str(),
                                       d.location.c_str(),
                                       d.speed_mbit,
                                       d.version.major,
                                       d.version.minor,
                                       status,
                                       d.problem ? d.problem->message.c_str() : ""};
      visit(user, &device);
    }
    return {};
  });
}

sonoloft_status sonoloft_watch_usb(sonoloft_plug_callback callback, void* user, sonoloft_usb_watch** watch,
                                   sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(callback, watch); !given) return given;
    auto monitor = device::UsbMonitor::start([callback, user](const device::UsbPlugEvent& event) {
      callback(user, event.arrived ? 1 : 0, event.location.c_str());
    });
    if (!monitor) return tl::unexpected<Error>(monitor.error());
    *watch = new sonoloft_usb_watch{std::move(*monitor)};
    return {};
  });
}

void sonoloft_unwatch_usb(sonoloft_usb_watch* watch) {
  delete watch;
}

sonoloft_status sonoloft_open_usb(const char* serial, sonoloft_probe** probe, sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(probe); !given) return given;
    return hand_over(device::UsbTransport::open(serial ? serial : ""), probe);
  });
}

sonoloft_status sonoloft_open_simulated(const sonoloft_simulation* simulation, sonoloft_probe** probe,
                                        sonoloft_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (auto given = need(probe); !given) return given;
    const auto options = simulation_of(simulation);
    if (!options) return tl::unexpected<Error>(options.error());
    return hand_over(open_simulated_probe(*options), probe);
  });
}

void sonoloft_close_probe(sonoloft_probe* probe) {
  delete probe;
}
