// A scan: every new mesh is told of.
#include <cstdio>
#include <semaphore>

#include "host/scan/scan_session.h"
#include "host/simulated/simulated_probe.h"

using namespace sonoloft;

int main() {
  auto probe = open_simulated_probe({.slices = 40, .rate_hz = 20});  // or device::UsbTransport::open()
  if (!probe) return std::fprintf(stderr, "%s\n", probe.error().message.c_str()), 1;
  ScanOptions options;
  options.reconstructor.box = {Eigen::Vector3d::Constant(-300), Eigen::Vector3d::Constant(300)};  // mm
  options.reconstructor.spacing_mm = 4;
  const auto scan = ScanSession::open(std::move(*probe), options);
  if (!scan) return std::fprintf(stderr, "%s\n", scan.error().message.c_str()), 1;

  std::counting_semaphore<> end(0);
  ScanCallbacks callbacks;
  callbacks.on_mesh = [](std::shared_ptr<const MeshUpdate> update) {
    std::printf("slice %2llu: %zu triangles\n", static_cast<unsigned long long>(update->revision),
                update->size.triangles);
    for (const LabelStatistics& l : update->labels) std::printf("  label %d: %.0f ml\n", l.label, l.volume_ml);
  };
  callbacks.on_event = [&end](const ScanEvent& event) {
    std::printf("%s\n", event.message.c_str());
    if (ends_run(event.kind)) end.release();
  };
  if (auto started = (*scan)->start(callbacks); !started)
    return std::fprintf(stderr, "%s\n", started.error().message.c_str()), 1;
  end.acquire();
}
