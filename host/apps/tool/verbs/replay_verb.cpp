#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "host/apps/tool/figures.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/live/live_scan.h"
#include "host/apps/tool/verbs/verbs.h"
#include "host/record/replay/replay_transport.h"

namespace sonoloft::tool {
namespace {

struct ReplayOptions {
  std::filesystem::path recording;
  std::optional<std::filesystem::path> output, labels;
  double speed = 1;  ///< 0: as fast as slices are used
  ScanSpace space;
  ViewChoice view;
  IgtlChoice igtl;
};

/// FNV-1a over positions, triangles and labels: equal for meshes that are equal byte for byte.
std::uint64_t hash(const IndexedMesh& mesh) {
  std::uint64_t hash = 0xCBF29CE484222325ull;
  const auto add = [&](const auto& values) {
    for (const std::byte byte : std::as_bytes(std::span(values)))
      hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001B3ull;
  };
  add(mesh.positions);
  add(mesh.triangles);
  add(mesh.label_front);
  add(mesh.label_back);
  return hash;
}

void print(const record::RecordingFacts& facts) {
  std::cout << facts.transfers << " records, " << facts.runs << (facts.runs == 1 ? " run, " : " runs, ")
            << facts.seconds << " s" << std::endl;
  if (facts.cut) std::cerr << "sonoloft: " << *facts.cut << "; what comes before is replayed\n";
}

Result<void> run_replay(const ReplayOptions& replay) {
  const auto labels = read_labels(replay.labels);
  if (!labels) return tl::unexpected<Error>(labels.error());
  const auto options = scan_options(replay.space, device::StreamMode::lossless);
  if (!options) return tl::unexpected<Error>(options.error());
  auto opened = record::ReplayTransport::open(replay.recording, replay.speed);
  if (!opened) return tl::unexpected<Error>(opened.error());
  const record::ReplayTransport& transport = **opened;  // the scan's
  print(transport.facts());
  const auto scan = ScanSession::open(std::move(*opened), *options);
  if (!scan) return tl::unexpected<Error>(scan.error());
  const auto view = ScanView::open(replay.view, **scan, *labels);
  if (!view) return tl::unexpected<Error>(view.error());
  const auto igtl = IgtlOutput::open(replay.igtl, *labels);
  if (!igtl) return tl::unexpected<Error>(igtl.error());
  note_interrupts();
  const auto mesh = scan_all(**scan, *view, *igtl, [&] { return transport.more(); });
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  std::printf("mesh %016llx  %zu vertices  %zu triangles\n", 0ull + hash(*mesh), mesh->positions.size(),
              mesh->triangles.size());
  if (replay.output)
    if (auto written = write_mesh(*mesh, *replay.output, *labels); !written) return written;
  view->linger();
  return {};
}

}  // namespace

void add_replay(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("replay", "Scans with a recorded probe, and says by a hash which mesh came out");
  auto replay = std::make_shared<ReplayOptions>();
  verb->add_option("recording", replay->recording, "File that `sonoloft record` wrote")->required();
  verb->add_option("-o,--output", replay->output, std::string("Mesh to write: ") + kMeshSuffixes)
      ->check(ends_in(kMeshSuffixes));
  add_labels(*verb, replay->labels);
  verb->add_option_function<std::string>(
          "--speed", [replay](const std::string& text) { replay->speed = text == "max" ? 0 : std::stod(text); },
          "Times as fast as it was recorded; max: as fast as slices are used")
      ->check(finite(1e-3, 1e3) | CLI::IsMember({"max"}))
      ->default_str("1");
  add_scan_space(*verb, replay->space);
  add_view(*verb, replay->view);
  add_igtl(*verb, replay->igtl);
  verb->callback([&task, replay] { task = [replay] { return run_replay(*replay); }; });
}

}  // namespace sonoloft::tool
