#include <cstdio>
#include <memory>
#include <set>
#include <utility>

#include "core/io/meshes/mesh_files.h"
#include "host/apps/tool/benchmark/benchmark.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/figures.h"
#include "host/apps/tool/phantom/body.h"
#include "host/apps/tool/verbs/verbs.h"

namespace sonoloft::tool {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::filesystem::path mesh, truth;
  BenchmarkOptions benchmark{{}, 8, ReconstructorOptions{}.field, 1};  ///< with a folder: instead of mesh and truth
  int threads;
  std::optional<std::filesystem::path> report;
};

/// Grey values mean the labels that the demo made of them; voxels that have the mesh's labels are taken as they are.
void agree_on_labels(const IndexedMesh& mesh, LabelVolume& voxels) {
  const std::set<Label> known(voxels.labels.begin(), voxels.labels.end());
  std::set<Label> asked(mesh.label_back.begin(), mesh.label_back.end());
  asked.insert(mesh.label_front.begin(), mesh.label_front.end());
  asked.erase(kOutside);
  for (const Label label : asked) {
    if (known.contains(label)) continue;
    const std::vector<Label> values = number_by_volume(voxels);
    for (std::size_t i = 0; i < values.size(); ++i)
      std::printf("truth: grey value %u is label %zu\n", unsigned{values[i]}, i + 1);
    return;
  }
}

Json json(const SurfaceDistance& distance, double diagonal_mm) {
  return {{"mean", distance.mean_mm / diagonal_mm}, {"max", distance.max_mm / diagonal_mm}};
}

Json report_json(const Comparison& c) {
  Json labels = Json::object();
  for (std::size_t i = 0; i < c.overlaps.size(); ++i)
    labels[std::to_string(c.overlaps[i].label)] = {{"iou", c.overlaps[i].iou()},
                                                   {"dice", c.overlaps[i].dice()},
                                                   {"distance", json(c.distances[i].distance, c.truth_diagonal_mm)}};
  return {{"labels", labels},
          {"surface_distance", json(c.surface, c.truth_diagonal_mm)},
          {"truth_diagonal_mm", c.truth_diagonal_mm},
          {"open_lines", c.open_lines}};
}

void print(const Comparison& c) {
  std::printf("%8s %8s %8s %14s %14s\n", "label", "IoU", "Dice", "mean/diagonal", "max/diagonal");
  for (std::size_t i = 0; i < c.overlaps.size(); ++i)
    std::printf("%8u %8.4f %8.4f %14.6f %14.6f\n", unsigned{c.overlaps[i].label}, c.overlaps[i].iou(),
                c.overlaps[i].dice(), c.distances[i].distance.mean_mm / c.truth_diagonal_mm,
                c.distances[i].distance.max_mm / c.truth_diagonal_mm);
  std::printf("%8s %8s %8s %14.6f %14.6f\n", "all", "", "", c.surface.mean_mm / c.truth_diagonal_mm,
              c.surface.max_mm / c.truth_diagonal_mm);
  if (c.open_lines > 0)
    std::printf("%zu scan lines met a border an odd number of times: a surface is not closed\n", c.open_lines);
}

Result<void> run_evaluate(const EvaluateOptions& o) {
  const auto mesh = read_mesh(o.mesh);
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  auto truth = load_truth(o.truth);
  if (!truth) return tl::unexpected<Error>(truth.error());
  if (auto* voxels = std::get_if<LabelVolume>(&*truth)) agree_on_labels(*mesh, *voxels);
  const auto compared = compare(*mesh, *truth, o.threads);
  if (!compared) return tl::unexpected<Error>(compared.error());
  print(*compared);
  return o.report ? write_report(report_json(*compared), *o.report) : Result<void>{};
}

Result<void> run_folder(const EvaluateOptions& o) {
  BenchmarkOptions benchmark = o.benchmark;
  benchmark.threads = o.threads;
  const auto report = run_benchmark(benchmark);
  if (!report) return tl::unexpected<Error>(report.error());
  if (o.report)
    if (auto written = write_report(*report, *o.report); !written) return written;
  const auto failed = (*report)["failed"].get<std::size_t>();
  if (failed == 0) return {};
  return fail(ErrorCode::invalid_argument,
              std::to_string(failed) + " of the sets could not be evaluated: see the lines above");
}

}  // namespace

void add_evaluate(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("evaluate", "Compares a mesh with the truth: IoU and Dice of every label, distances");
  auto options = std::make_shared<EvaluateOptions>();
  auto* what = verb->add_option_group("What to evaluate")->require_option(1);
  auto* mesh = what->add_option("mesh", options->mesh, "Mesh: .ply, .obj, .stl, .off");
  auto* benchmark =
      what->add_option("--benchmark", options->benchmark.folder,
                       "A folder of slices, each with its truth (NAME.csl or NAME.contour beside NAME.ply, "
                       ".off, .obj or .stl): all are reconstructed and measured");
  auto* truth = verb->add_option("--truth", options->truth, "The truth: a mesh, or voxels (.inr, .inr.gz)");
  mesh->needs(truth);
  truth->excludes(benchmark);
  verb->add_option("--depth", options->benchmark.depth,
                   "Of a benchmark: the longest side is about 2^depth finest cells long")
      ->check(CLI::Range(5, 10))
      ->needs(benchmark)
      ->capture_default_str();
  add_field(*verb, options->benchmark.field);
  verb->get_option("--field")->needs(benchmark);
  add_threads(*verb, options->threads);
  add_report(*verb, options->report);
  verb->callback([&task, options] {
    task = [options] { return options->benchmark.folder.empty() ? run_evaluate(*options) : run_folder(*options); };
  });
}

}  // namespace sonoloft::tool
