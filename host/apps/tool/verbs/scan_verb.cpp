#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <memory>
#include <thread>
#include <utility>

#include "host/apps/tool/common_options.h"
#include "host/apps/tool/figures.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/phantom/simulated_probe_options.h"
#include "host/apps/tool/scan_log.h"
#include "host/apps/tool/verbs/verbs.h"
#include "host/device/loopback/loopback_transport.h"
#include "host/device/usb/usb_transport.h"
#include "host/scan/scan_session.h"

namespace sonoloft::tool {
namespace {

struct LiveOptions {
  std::string serial;
  bool simulated = false;
  SimulatedProbeOptions probe;
  std::filesystem::path output;
  std::array<double, 6> box{-200, -200, -200, 200, 200, 200};
  double spacing_mm = 2;
  bool lossless = false;
  Compute compute;
};

Result<ScanOptions> scan_options(const LiveOptions& live) {
  const auto& b = live.box;
  ScanOptions options;
  options.reconstructor.box = {Eigen::Vector3d(b[0], b[1], b[2]), Eigen::Vector3d(b[3], b[4], b[5])};
  if (options.reconstructor.box.isEmpty())
    return fail(ErrorCode::invalid_argument, "--box has no inside: give its lowest corner, then its highest");
  options.reconstructor.spacing_mm = live.spacing_mm;
  options.reconstructor.device = live.compute.device;
  options.reconstructor.threads = live.compute.threads;
  options.reconstructor.log = [](const std::string& line) { std::cout << line << '\n'; };
  if (live.lossless) options.stream.mode = device::StreamMode::lossless;
  return options;
}

/// A run of the scan, until it ends by itself or by Ctrl-C; a line whenever there is something new to say.
void follow(ScanLog& log) {
  std::string told;
  bool end = false;
  while (!end) {
    end = interrupted() || log.wait_for_end(std::chrono::seconds(1));
    const std::string line = log.progress();
    if (line != told) std::cout << line << std::endl;
    told = line;
  }
}

/// Until the data end or Ctrl-C. A probe that was unplugged is waited for, and the scan goes on with it.
/// @return the last mesh, null where there was none
Result<std::shared_ptr<const MeshUpdate>> scan_all(ScanSession& scan) {
  constexpr std::chrono::milliseconds kLookAgain{200};
  std::shared_ptr<const MeshUpdate> last;
  while (!interrupted()) {
    ScanLog log;
    if (auto started = scan.start(log.callbacks()); !started) {
      const auto code = started.error().code;
      const bool absent = code == ErrorCode::device_not_found || code == ErrorCode::transport_closed;
      if (!absent) return tl::unexpected<Error>(started.error());
      std::this_thread::sleep_for(kLookAgain);
      continue;
    }
    follow(log);
    scan.stop();
    if (const auto failure = log.failure()) return fail(ErrorCode::opencl_failed, *failure);
    if (log.last()) last = log.last();
    if (log.data_ended()) break;
  }
  return last;
}

Result<std::unique_ptr<device::Transport>> open_usb(const std::string& serial) {
  auto transport = device::UsbTransport::open(serial);
  if (!transport) return tl::unexpected<Error>(transport.error());
  std::cout << "probe " << (*transport)->serial() << ", USB at " << (*transport)->speed_mbit() << " Mbit/s\n";
  return std::move(*transport);
}

Result<std::unique_ptr<device::Transport>> open_simulated(const SimulatedProbeOptions& probe,
                                                          std::unique_ptr<SimulatedScan>& simulated) {
  const auto body = load_body(probe.phantom, probe.data);
  if (!body) return tl::unexpected<Error>(body.error());
  auto made = SimulatedScan::make(*body, probe.plan);
  if (!made) return tl::unexpected<Error>(made.error());
  simulated = std::move(*made);
  return std::make_unique<device::LoopbackTransport>(simulated->port());
}

Result<void> run_scan(const LiveOptions& live) {
  const auto options = scan_options(live);
  if (!options) return tl::unexpected<Error>(options.error());
  std::unique_ptr<SimulatedScan> simulated;  // outlives the scan
  auto transport = live.simulated ? open_simulated(live.probe, simulated) : open_usb(live.serial);
  if (!transport) return tl::unexpected<Error>(transport.error());
  const auto scan = ScanSession::open(std::move(*transport), *options);
  if (!scan) return tl::unexpected<Error>(scan.error());
  note_interrupts();
  const auto last = scan_all(**scan);
  if (!last) return tl::unexpected<Error>(last.error());
  if (!*last) return fail(ErrorCode::empty_input, "no slice came before the scan was stopped: let it run longer");
  const IndexedMesh mesh = (*last)->mesh.indexed();
  if (mesh.triangles.empty())
    return fail(ErrorCode::empty_input, "the slices bound nothing in --box: scan the whole body, or move the box");
  return write_mesh(mesh, live.output);
}

}  // namespace

void add_scan(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("scan", "Scans with a probe and writes the mesh, until the probe ends or Ctrl-C");
  auto live = std::make_shared<LiveOptions>();
  verb->add_option("-o,--output", live->output, std::string("Mesh to write: ") + kMeshSuffixes)
      ->required()
      ->check(ends_in(kMeshSuffixes));
  verb->add_option("--serial", live->serial, "The probe; default: the only one that is plugged in");
  verb->add_flag("--simulated", live->simulated, "A simulated probe in this program instead of one on USB");
  add_simulated_probe(*verb, live->probe);
  verb->add_option("--box", live->box, "Space of the scan, reference frame, mm: lowest x y z, highest x y z")
      ->check(finite(-1e5, 1e5))
      ->capture_default_str();
  verb->add_option("--resolution-mm", live->spacing_mm, "Finest cells: their edge in mm")
      ->check(finite(1e-3, 1e3))
      ->capture_default_str();
  verb->add_flag("--lossless", live->lossless,
                 "Hold the probe back where the mesh does not follow; it must be able to");
  add_compute(*verb, live->compute);
  verb->callback([&task, live] { task = [live] { return run_scan(*live); }; });
}

}  // namespace sonoloft::tool
