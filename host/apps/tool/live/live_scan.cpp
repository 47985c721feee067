#include "host/apps/tool/live/live_scan.h"

#include <chrono>
#include <iostream>
#include <string>
#include <thread>

#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/scan_log.h"

namespace sonoloft::tool {
namespace {

/// A run of the scan, until it ends by itself or by Ctrl-C; a line whenever there is something new to say.
void follow(ScanLog& log, const ScanView& view) {
  std::string told;
  bool end = false;
  while (!end) {
    end = interrupted() || view.stopped() || log.wait_for_end(std::chrono::seconds(1));
    const std::string line = log.progress();
    if (line != told) std::cout << line << std::endl;
    told = line;
  }
}

/// @return the last mesh, null where there was none
Result<std::shared_ptr<const MeshUpdate>> run_all(ScanSession& scan, const ScanView& view, const IgtlOutput& igtl,
                                                  const std::function<bool()>& more) {
  constexpr std::chrono::milliseconds kLookAgain{200};
  std::shared_ptr<const MeshUpdate> last;
  while (!interrupted() && !view.stopped()) {
    ScanLog log;
    if (auto started = scan.start(igtl.shown(view.shown(log.callbacks()))); !started) {
      const auto code = started.error().code;
      const bool absent = code == ErrorCode::device_not_found || code == ErrorCode::transport_closed;
      if (!absent) return tl::unexpected<Error>(started.error());
      std::this_thread::sleep_for(kLookAgain);
      continue;
    }
    follow(log, view);
    scan.stop();
    if (const auto failure = log.failure()) return fail(ErrorCode::opencl_failed, *failure);
    if (log.last()) last = log.last();
    if (log.data_ended() && !more()) break;
  }
  return last;
}

}  // namespace

void add_scan_space(CLI::App& verb, ScanSpace& space) {
  verb.add_option("--box", space.box, "Space of the scan, reference frame, mm: lowest x y z, highest x y z")
      ->check(finite(-1e5, 1e5))
      ->capture_default_str();
  verb.add_option("--resolution-mm", space.spacing_mm, "Finest cells: their edge in mm")
      ->check(finite(1e-3, 1e3))
      ->capture_default_str();
  add_compute(verb, space.compute);
}

Result<ScanOptions> scan_options(const ScanSpace& space, device::StreamMode mode) {
  const auto& b = space.box;
  ScanOptions options;
  options.reconstructor.box = {Eigen::Vector3d(b[0], b[1], b[2]), Eigen::Vector3d(b[3], b[4], b[5])};
  if (options.reconstructor.box.isEmpty())
    return fail(ErrorCode::invalid_argument, "--box has no inside: give its lowest corner, then its highest");
  options.reconstructor.spacing_mm = space.spacing_mm;
  options.reconstructor.device = space.compute.device;
  options.reconstructor.threads = space.compute.threads;
  options.reconstructor.log = [](const std::string& line) { std::cout << line << '\n'; };
  options.stream.mode = mode;
  return options;
}

Result<IndexedMesh> scan_all(ScanSession& scan, const ScanView& view, const IgtlOutput& igtl,
                             const std::function<bool()>& more) {
  const auto last = run_all(scan, view, igtl, more);
  if (!last) return tl::unexpected<Error>(last.error());
  if (!*last) return fail(ErrorCode::empty_input, "no slice came before the scan was stopped: let it run longer");
  IndexedMesh mesh = (*last)->mesh.indexed();
  if (mesh.triangles.empty())
    return fail(ErrorCode::empty_input, "the slices bound nothing in --box: scan the whole body, or move the box");
  return mesh;
}

}  // namespace sonoloft::tool
