#include <memory>
#include <utility>

#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/live/live_scan.h"
#include "host/apps/tool/live/probe_source.h"
#include "host/apps/tool/mesh_output.h"
#include "host/apps/tool/verbs/verbs.h"

namespace sonoloft::tool {
namespace {

struct LiveOptions {
  ProbeSource source;
  MeshOutput output;
  std::optional<std::filesystem::path> labels;
  ScanSpace space;
  ViewChoice view;
  IgtlChoice igtl;
  bool lossless = false;
};

Result<void> run_scan(const LiveOptions& live) {
  const auto labels = read_labels(live.labels);
  if (!labels) return tl::unexpected<Error>(labels.error());
  const auto mode = live.lossless ? device::StreamMode::lossless : device::StreamMode::live;
  const auto options = scan_options(live.space, mode);
  if (!options) return tl::unexpected<Error>(options.error());
  auto probe = open_probe(live.source);
  if (!probe) return tl::unexpected<Error>(probe.error());
  auto transport = std::make_unique<record::RecordingTransport>(std::move(probe->transport));
  auto recorder = std::make_unique<ScanRecorder>(*transport, live.output.path.parent_path());
  const auto scan = ScanSession::open(std::move(transport), *options);
  if (!scan) return tl::unexpected<Error>(scan.error());
  const auto view = ScanView::open(live.view, **scan, *labels, std::move(recorder));
  if (!view) return tl::unexpected<Error>(view.error());
  const auto igtl = IgtlOutput::open(live.igtl, *labels);
  if (!igtl) return tl::unexpected<Error>(igtl.error());
  note_interrupts();
  const auto mesh = scan_all(**scan, *view, *igtl, [] { return false; });
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  auto written = write_output(*mesh, live.output, *labels, live.space.spacing_mm, live.space.compute.threads);
  if (written) view->linger();
  return written;
}

}  // namespace

void add_scan(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("scan", "Scans with a probe and writes the mesh, until the probe ends or Ctrl-C");
  auto live = std::make_shared<LiveOptions>();
  add_mesh_output(*verb, live->output);
  add_labels(*verb, live->labels);
  add_probe_source(*verb, live->source);
  add_scan_space(*verb, live->space);
  add_view(*verb, live->view);
  add_igtl(*verb, live->igtl);
  verb->add_flag("--lossless", live->lossless,
                 "Hold the probe back where the mesh does not follow; it must be able to");
  verb->callback([&task, live] { task = [live] { return run_scan(*live); }; });
}

}  // namespace sonoloft::tool
