#include "host/apps/tool/benchmark/benchmark.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/io/meshes/mesh_files.h"
#include "core/io/slices/slice_files.h"
#include "core/reconstructor/reconstructor.h"
#include "host/apps/measure/accuracy.h"

namespace sonoloft::tool {
namespace {

using Json = nlohmann::ordered_json;
using Path = std::filesystem::path;

struct Column {
  const char* key;  ///< in the JSON
  const char* head;
  int width, decimals;
};
constexpr Column kColumns[] = {{"planes", "planes", 6, 0},
                               {"iou", "IoU", 7, 4},
                               {"mislabelled", "wrong", 7, 4},
                               {"mean_percent", "mean %", 7, 3},
                               {"hausdorff_percent", "max %", 6, 2},
                               {"pieces", "pieces", 6, 0},
                               {"truth_pieces", "truth", 6, 0},
                               {"large_pieces", "large", 6, 0},
                               {"truth_large_pieces", "truth", 6, 0},
                               {"genus", "genus", 6, 0},
                               {"truth_genus", "truth", 6, 0},
                               {"turn_deg", "turn", 6, 1},
                               {"truth_turn_deg", "truth", 6, 1},
                               {"crease_deg", "crease", 6, 1},
                               {"lean_deg", "lean", 6, 1}};

Result<std::vector<Path>> slice_files_in(const Path& folder) {
  std::error_code error;
  std::vector<Path> files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (const Path& path = entry->path(); path.extension() == ".csl" || path.extension() == ".contour")
      files.push_back(path);
  if (error) return fail(ErrorCode::io_failed, folder.string() + ": " + error.message() + ": name a folder");
  if (files.empty())
    return fail(ErrorCode::empty_input,
                folder.string() + " holds no .csl and no .contour: put slices there, and beside each its true mesh");
  std::sort(files.begin(), files.end());
  return files;
}

Result<Path> truth_beside(const Path& slices) {
  for (const char* suffix : {".ply", ".off", ".obj", ".stl"}) {
    Path truth = slices;
    std::error_code ignored;
    if (std::filesystem::exists(truth.replace_extension(suffix), ignored)) return truth;
  }
  return fail(ErrorCode::file_not_found,
              slices.string() + " has no truth: put " + slices.stem().string() + ".ply, .off, .obj or .stl beside it");
}

Result<IndexedMesh> reconstructed(const std::vector<TrackedSlice>& slices, const BenchmarkOptions& o) {
  auto options = options_for(slices, o.depth);
  if (!options) return tl::unexpected<Error>(options.error());
  options->field = o.field;
  options->admission = Admission::everything;
  options->threads = o.threads;
  auto reconstructor = Reconstructor::create(*options);
  if (!reconstructor) return tl::unexpected<Error>(reconstructor.error());
  for (const TrackedSlice& slice : slices)
    if (const auto added = reconstructor->add(slice); !added) return tl::unexpected<Error>(added.error());
  if (const auto updated = reconstructor->update(); !updated) return tl::unexpected<Error>(updated.error());
  return reconstructor->mesh().indexed();
}

Json json(const Accuracy& accuracy, std::size_t planes) {
  Json figures{{"planes", planes}};
  for (const auto& [name, value] : figures_of(accuracy)) figures[name] = value;
  for (const LabelAgreement& label : accuracy.agreement.labels)
    figures["iou_of_labels"][std::to_string(label.label)] = label.iou();
  return figures;
}

Result<Json> evaluate_set(const Path& file, const BenchmarkOptions& o) {
  const auto truth_file = truth_beside(file);
  if (!truth_file) return tl::unexpected<Error>(truth_file.error());
  const auto slices = file.extension() == ".csl" ? read_csl(file) : read_contour(file);
  if (!slices) return tl::unexpected<Error>(slices.error());
  const auto truth = read_mesh(*truth_file);
  if (!truth) return tl::unexpected<Error>(truth.error());
  const auto mesh = reconstructed(slices->slices, o);
  if (!mesh) return fail(mesh.error().code, file.string() + ": " + mesh.error().message);
  const auto accuracy = measure_accuracy(*mesh, slices->slices, {*truth}, o.threads);
  if (!accuracy) return fail(accuracy.error().code, truth_file->string() + ": " + accuracy.error().message);
  return json(*accuracy, slices->slices.size());
}

void print_heads(int name_width) {
  std::printf("%-*s", name_width, "set");
  for (const Column& column : kColumns) std::printf(" %*s", column.width, column.head);
  std::printf("\n");
}

void print_line(const std::string& name, const Json& figures, int name_width) {
  std::printf("%-*s", name_width, name.c_str());
  for (const Column& column : kColumns)
    std::printf(" %*.*f", column.width, column.decimals, figures[column.key].get<double>());
  std::printf("\n");
  std::fflush(stdout);
}

Json means_of(const Json& sets) {
  Json means;
  for (const Column& column : kColumns) {
    double sum = 0;
    for (const auto& [name, figures] : sets.items()) sum += figures[column.key].get<double>();
    means[column.key] = sum / static_cast<double>(sets.size());
  }
  return means;
}

}  // namespace

Result<Json> run_benchmark(const BenchmarkOptions& o) {
  const auto files = slice_files_in(o.folder);
  if (!files) return tl::unexpected<Error>(files.error());
  std::size_t name_width = 4;
  for (const Path& file : *files) name_width = std::max(name_width, file.stem().string().size());
  std::printf("%zu points a set; pieces are large from 1e-5 of the box; degrees in bands of 1 %% of the diagonal\n",
              kAgreementPoints);
  print_heads(static_cast<int>(name_width));
  Json sets = Json::object();
  std::size_t failed = 0;
  for (const Path& file : *files) {
    const auto figures = evaluate_set(file, o);
    if (!figures) {
      std::cerr << "sonoloft: " << figures.error().message << '\n';
      ++failed;
      continue;
    }
    sets[file.stem().string()] = *figures;
    print_line(file.stem().string(), *figures, static_cast<int>(name_width));
  }
  Json report{{"field", o.field == FieldMethod::step ? "step" : "smooth"},
              {"depth", o.depth},
              {"points", kAgreementPoints},
              {"sets", sets},
              {"failed", failed}};
  if (!sets.empty()) {
    report["mean"] = means_of(sets);
    print_line("mean", report["mean"], static_cast<int>(name_width));
  }
  return report;
}

}  // namespace sonoloft::tool
