#include <memory>
#include <optional>
#include <utility>

#include "core/io/meshes/mesh_files.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/live/scan_view.h"
#include "host/apps/tool/verbs/verbs.h"
#include "host/scan/label_statistics.h"
#include "host/view/split_mesh.h"

namespace sonoloft::tool {
namespace {

struct ViewVerbOptions {
  std::filesystem::path mesh;
  std::optional<std::filesystem::path> labels;
  view::ViewOptions place;
};

Result<void> run_view(const ViewVerbOptions& options) {
  const auto mesh = read_mesh(options.mesh);
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  if (mesh->triangles.empty()) return fail(ErrorCode::empty_input, options.mesh.string() + " has no triangle");
  auto labels = read_labels(options.labels);
  if (!labels) return tl::unexpected<Error>(labels.error());
  auto update = std::make_shared<MeshUpdate>();
  update->mesh = view::split(*mesh);
  update->labels = LabelStatisticsKeeper(mesh->positions.front().cast<double>()).update(update->mesh, {});
  view::ViewSource source;
  source.labels = std::move(*labels);
  const auto server = open_view(options.place, std::move(source));
  if (!server) return tl::unexpected<Error>(server.error());
  (*server)->show(options.mesh.filename().string());
  (*server)->show(std::shared_ptr<const MeshUpdate>(std::move(update)));
  note_interrupts();
  wait_for_interrupt();
  return {};
}

}  // namespace

void add_view_verb(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("view", "Shows a mesh on a page for the browser");
  auto options = std::make_shared<ViewVerbOptions>();
  verb->add_option("mesh", options->mesh, "Mesh to show: .ply, .stl, .obj, .off (a recording: sonoloft replay --view)")
      ->required();
  add_labels(*verb, options->labels);
  add_view_place(*verb, options->place);
  verb->callback([&task, options] { task = [options] { return run_view(*options); }; });
}

}  // namespace sonoloft::tool
