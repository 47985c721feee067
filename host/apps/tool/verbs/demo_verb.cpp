#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <utility>

#include "core/io/slices/slice_files.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/figures.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/live/igtl_output.h"
#include "host/apps/tool/live/scan_view.h"
#include "host/apps/tool/phantom/body.h"
#include "host/apps/tool/phantom/simulated_probe_options.h"
#include "host/apps/tool/scan_log.h"
#include "host/apps/tool/verbs/verbs.h"
#include "host/device/loopback/loopback_transport.h"
#include "host/scan/scan_session.h"

namespace sonoloft::tool {
namespace {

using Json = nlohmann::ordered_json;

struct DemoOptions {
  SimulatedProbeOptions probe;
  std::optional<double> seconds;
  std::filesystem::path out = "out";
  std::optional<std::filesystem::path> labels, report, saved_slices;
  Resolution resolution{7, {}};  ///< coarse enough to follow 10 slices a second on two cores
  Compute compute;
  FieldMethod field = ReconstructorOptions{}.field;
  Admission admission = Admission::news;
  ViewChoice view;
  IgtlChoice igtl;
};

Result<ScanOptions> scan_options(const DemoOptions& demo, const Eigen::AlignedBox3d& body) {
  const double longest_mm = body.sizes().maxCoeff();
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(longest_mm);
  ScanOptions options;
  options.reconstructor.box = {body.min() - margin, body.max() + margin};
  const auto spacing_mm = spacing(demo.resolution, longest_mm);
  if (!spacing_mm) return tl::unexpected<Error>(spacing_mm.error());
  options.reconstructor.spacing_mm = *spacing_mm;
  options.reconstructor.background_mm = longest_mm / 64;
  options.reconstructor.field = demo.field;
  options.reconstructor.admission = demo.admission;
  options.reconstructor.device = demo.compute.device;
  options.reconstructor.threads = demo.compute.threads;
  options.reconstructor.log = [](const std::string& line) { std::cout << line << '\n'; };
  if (demo.probe.plan.rate_hz == 0) options.stream.mode = device::StreamMode::lossless;
  return options;
}

/// Until the data end, Ctrl-C or a stop from the page: a line that is rewritten on a terminal, else a line a second.
void follow(ScanLog& log, const ScanView& view) {
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  const auto show = [&] { std::cout << log.progress() << (terminal ? "    \r" : "\n") << std::flush; };
  auto next_line = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  while (!interrupted() && !view.stopped() && !log.wait_for_end(std::chrono::milliseconds(100))) {
    if (!terminal && std::chrono::steady_clock::now() < next_line) continue;
    next_line += std::chrono::seconds(1);
    show();
  }
  show();
  if (terminal) std::cout << '\n';
}

Json slices_json(const SliceCounts& c) {
  return {{"delivered", c.delivered}, {"inserted", c.inserted}, {"explained", c.explained},
          {"merged", c.merged},       {"refused", c.refused},   {"dropped", c.dropped}};
}

Json ledger_json(const device::Ledger& l) {
  return {{"sent", l.made},
          {"delivered", l.delivered},
          {"host_dropped", l.host_dropped},
          {"crc_bad", l.crc_bad},
          {"malformed", l.malformed},
          {"transport_lost", l.transport_lost},
          {"device_dropped", l.device_dropped},
          {"closed", l.closed}};
}

Json labels_json(const std::vector<LabelStatistics>& labels, const LabelTable& table) {
  Json all = Json::object();
  for (const LabelStatistics& s : labels)
    all[std::to_string(s.label)] = {
        {"name", table.name(s.label)}, {"triangles", s.triangles}, {"volume_ml", s.volume_ml}};
  return all;
}

/// Dice of every label; empty without a truth.
Result<Json> dice_json(const IndexedMesh& mesh, const Truth& truth, int threads) {
  Json dice = Json::object();
  if (std::holds_alternative<std::monostate>(truth)) return dice;
  const auto compared = compare(mesh, truth, threads);
  if (!compared) return tl::unexpected<Error>(compared.error());
  for (const LabelOverlap& overlap : compared->overlaps) dice[std::to_string(overlap.label)] = overlap.dice();
  return dice;
}

std::string text_of(const LabelStatistics& label, const LabelTable& table, const Json& dice) {
  char figures[64];
  const std::string key = std::to_string(label.label);
  int size = std::snprintf(figures, sizeof figures, "  %.4g ml", label.volume_ml);
  if (dice.contains(key))
    std::snprintf(figures + size, sizeof figures - static_cast<std::size_t>(size), "  Dice %.3f",
                  dice[key].get<double>());
  return table.name(label.label) + figures;
}

void print(const char* what, const Percentiles& ms) {
  char line[96];
  std::snprintf(line, sizeof line, "%-8s p50 %.1f  p95 %.1f  max %.1f ms", what, ms.p50, ms.p95, ms.max);
  std::cout << line << '\n';
}

void print(const Json& report, const std::vector<LabelStatistics>& labels, const LabelTable& table) {
  for (const LabelStatistics& label : labels) std::cout << text_of(label, table, report["dice"]) << '\n';
  for (const char* group : {"slices", "ledger"}) {
    std::cout << group << ':';
    for (const auto& [key, value] : report[group].items()) std::cout << "  " << key << ' ' << value;
    std::cout << '\n';
  }
}

Json coverage_json(const Coverage& coverage) {
  Json json = {{"volume_ml", 1e-3 * coverage.volume_mm3}, {"seen", coverage.seen_fraction()}};
  if (!coverage.largest_gap) return json;
  const CoverageGap& gap = *coverage.largest_gap;
  const Eigen::Isometry3d& plane = gap.suggested_image_to_reference;
  const auto list = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  json["largest_gap"] = {{"volume_ml", 1e-3 * gap.volume_mm3},
                         {"centre_mm", list(gap.centre_mm)},
                         {"deepest_mm", gap.deepest_mm},
                         {"suggested_origin_mm", list(plane.translation())},
                         {"suggested_normal", list(plane.linear().col(2))}};
  return json;
}

void print(const Coverage& coverage) {
  char line[160];
  std::snprintf(line, sizeof line, "coverage %.1f %% of %.4g ml were seen", 100 * coverage.seen_fraction(),
                1e-3 * coverage.volume_mm3);
  std::cout << line;
  if (coverage.largest_gap) {
    const Eigen::Vector3d& at = coverage.largest_gap->centre_mm;
    std::snprintf(line, sizeof line, "; largest gap %.3g ml around (%.0f, %.0f, %.0f) mm",
                  1e-3 * coverage.largest_gap->volume_mm3, at.x(), at.y(), at.z());
    std::cout << line;
  }
  std::cout << '\n';
}

/// The enclosing label as glass, so that what it holds is seen.
std::vector<Label> glass_of(const std::vector<LabelStatistics>& labels) {
  if (labels.size() < 2) return {};
  const auto less = [](const auto& a, const auto& b) { return a.volume_ml < b.volume_ml; };
  return {std::max_element(labels.begin(), labels.end(), less)->label};
}

Result<void> write_results(const DemoOptions& demo, const IndexedMesh& mesh, const Confidence& confidence,
                           const std::vector<LabelStatistics>& labels, const LabelTable& table, const Json& report) {
  const auto mesh_file = demo.out / "mesh.ply", picture_file = demo.out / "mesh.png";
  if (auto written = write_mesh(mesh, mesh_file, table, {confidence.measured, confidence.distance_mm}); !written)
    return written;
  std::vector<LegendLine> legend;
  for (const LabelStatistics& label : labels) legend.push_back({label.label, text_of(label, table, report["dice"])});
  auto drawn = write_picture(mesh, table, std::move(legend), glass_of(labels), picture_file, demo.compute.threads);
  if (!drawn) return drawn;
  std::cout << "written: " << mesh_file.string() << ", " << picture_file.string() << '\n';
  return demo.report ? write_report(report, *demo.report) : Result<void>{};
}

Result<void> judge(const DemoOptions& demo, const LabelTable& table, const Truth& truth, const ScanLog& log,
                   const ScanSession& scan) {
  if (const auto failure = log.failure()) return fail(ErrorCode::opencl_failed, *failure);
  const auto last = log.last();
  if (!last) return fail(ErrorCode::empty_input, "no slice came before the scan was stopped: let it run longer");
  const IndexedMesh mesh = last->mesh.indexed();
  if (mesh.triangles.empty())
    return fail(ErrorCode::empty_input, "the slices bound nothing: scan the whole body, with more slices");
  const auto dice = dice_json(mesh, truth, demo.compute.threads);
  if (!dice) return tl::unexpected<Error>(dice.error());
  const Coverage coverage = scan.coverage();
  const Percentiles latency = percentiles(log.latencies_ms()), insert = percentiles(log.reconstruct_ms());
  const Json report = {{"phantom", demo.probe.phantom},
                       {"device", scan.field_device()},
                       {"slices", slices_json(scan.counts())},
                       {"dice", *dice},
                       {"labels", labels_json(last->labels, table)},
                       {"triangles", mesh.triangles.size()},
                       {"cells", last->size.cells},
                       {"coverage", coverage_json(coverage)},
                       {"latency_ms", json(latency)},
                       {"insert_ms", json(insert)},
                       {"coarse_meshes", log.coarse_meshes()},
                       {"ledger", ledger_json(scan.ledger())}};
  print("latency", latency);
  print("insert", insert);
  print(report, last->labels, table);
  print(coverage);
  return write_results(demo, mesh, scan.confidence(mesh.positions), last->labels, table, report);
}

Result<void> run_demo(DemoOptions demo) {
  if (demo.seconds)
    demo.probe.plan.slices =
        static_cast<std::uint32_t>(std::max(1.0, std::round(*demo.seconds * demo.probe.plan.rate_hz)));
  const auto labels = read_labels(demo.labels);
  if (!labels) return tl::unexpected<Error>(labels.error());
  const auto body = load_body(demo.probe.phantom, demo.probe.data);
  if (!body) return tl::unexpected<Error>(body.error());
  const auto options = scan_options(demo, body->source->bounds());
  if (!options) return tl::unexpected<Error>(options.error());
  const auto device = SimulatedScan::make(*body, demo.probe.plan);
  if (!device) return tl::unexpected<Error>(device.error());
  ScanLog log;
  auto transport =
      std::make_unique<record::RecordingTransport>(std::make_unique<device::LoopbackTransport>((*device)->port()));
  auto recorder = std::make_unique<ScanRecorder>(*transport, demo.out);
  const auto scan = ScanSession::open(std::move(transport), *options);
  if (!scan) return tl::unexpected<Error>(scan.error());
  std::cout << demo.probe.phantom << ": " << (*device)->slices() << " slices, finest cells of "
            << options->reconstructor.spacing_mm << " mm, field on " << (*scan)->field_device() << std::endl;
  const auto view = ScanView::open(demo.view, **scan, *labels, std::move(recorder));
  if (!view) return tl::unexpected<Error>(view.error());
  const auto igtl = IgtlOutput::open(demo.igtl, *labels);
  if (!igtl) return tl::unexpected<Error>(igtl.error());
  note_interrupts();
  if (auto started = (*scan)->start(igtl->shown(view->shown(log.callbacks()))); !started) return started;
  follow(log, *view);
  (*scan)->stop();
  if (demo.saved_slices)
    if (auto written = write_csl((*device)->sent(), *demo.saved_slices); !written) return written;
  auto judged = judge(demo, *labels, body->truth, log, **scan);
  if (judged) view->linger();
  return judged;
}

}  // namespace

void add_demo(CLI::App& app, Task& task) {
  auto* verb =
      app.add_subcommand("demo", "Scans a phantom with a simulated probe, live, and says how good the mesh is");
  auto demo = std::make_shared<DemoOptions>();
  add_simulated_probe(*verb, demo->probe);
  verb->add_option("--seconds", demo->seconds, "Length of the sweep, instead of --slices")
      ->check(finite(0.1, 3600))
      ->excludes("--slices");
  verb->add_option("--out", demo->out, "Folder for mesh.ply and mesh.png")->capture_default_str();
  verb->add_option("--save-slices", demo->saved_slices, "Write the slices that were sent into this CSL file")
      ->check(ends_in(".csl"));
  add_labels(*verb, demo->labels);
  add_resolution(*verb, demo->resolution);
  add_field(*verb, demo->field);
  add_admission(*verb, demo->admission);
  add_compute(*verb, demo->compute);
  add_view(*verb, demo->view);
  add_igtl(*verb, demo->igtl);
  add_report(*verb, demo->report);
  verb->callback([&task, demo] {
    if (demo->seconds && demo->probe.plan.rate_hz == 0)
      throw CLI::ValidationError("--seconds", "needs a --rate above 0");
    task = [demo] { return run_demo(*demo); };
  });
}

}  // namespace sonoloft::tool
