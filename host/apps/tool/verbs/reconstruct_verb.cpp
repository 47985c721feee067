#include <chrono>
#include <iostream>
#include <memory>
#include <set>
#include <utility>

#include "core/reconstructor/reconstructor.h"
#include "host/apps/tool/common_options.h"
#include "host/apps/tool/figures.h"
#include "host/apps/tool/mesh_output.h"
#include "host/apps/tool/mesher.h"
#include "host/apps/tool/method_choice.h"
#include "host/apps/tool/slice_input.h"
#include "host/apps/tool/verbs/verbs.h"

namespace sonoloft::tool {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

/// Where a stack of slices ends.

struct ReconstructOptions {
  SliceInput input;
  MeshOutput output;
  bool online = false;
  FieldMethod field = ReconstructorOptions{}.field;
  Admission admission = Admission::everything;
  Caps caps = ReconstructorOptions{}.caps;
  Completion completion = Completion::background;
  std::optional<int> hops;
  Mesher mesher = Mesher::live;
  MethodChoice method;
  Resolution resolution;
  Compute compute;
  std::optional<std::filesystem::path> labels, report, picture;
};

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Times of a run, ms. total: from parsed slices to the finished mesh, without load and device_start.
struct Times {
  double load = 0, device_start = 0, cells = 0, completion = 0, slopes = 0, field = 0, octree = 0, mesh = 0, smooth = 0,
         delaunay = 0, total = 0;
  std::vector<double> per_slice;

  void add(const UpdateReport& update) {
    cells += update.cells_ms;
    completion += update.background_ms;
    slopes += update.slopes_ms;
    field += update.field_ms;
    octree += update.octree_ms;
    mesh += update.mesh_ms;
    smooth += update.smooth_ms;
  }
};

struct SliceOutcomes {
  std::size_t inserted = 0, explained = 0, merged = 0, refused = 0;

  std::size_t& of(SliceOutcome outcome) {
    return outcome == SliceOutcome::inserted ? inserted : outcome == SliceOutcome::explained ? explained : merged;
  }
};

Result<ReconstructorOptions> sized_for(const ReconstructOptions& o, std::span<const TrackedSlice> slices) {
  auto options = options_for(slices, o.resolution.depth);
  if (!options || !o.resolution.spacing_mm) return options;
  const auto spacing_mm = spacing(o.resolution, options->box.sizes().maxCoeff() / 3);  // the object and twice as much
  if (!spacing_mm) return tl::unexpected<Error>(spacing_mm.error());
  options->spacing_mm = *spacing_mm;
  return options;
}

Result<Reconstructor> prepare(const ReconstructOptions& o, std::span<const TrackedSlice> slices) {
  auto options = sized_for(o, slices);
  if (!options) return tl::unexpected<Error>(options.error());
  options->field = o.field;
  options->caps = o.caps;
  options->admission = o.admission;
  options->completion = o.completion;
  options->hops = o.hops;
  options->device = o.compute.device;
  options->threads = o.compute.threads;
  options->log = [](const std::string& line) { std::cout << line << '\n'; };
  return Reconstructor::create(*options);
}

Result<SliceOutcomes> reconstruct(std::span<const TrackedSlice> slices, bool online, Reconstructor& reconstructor,
                                  Times& times) {
  SliceOutcomes outcomes;
  const auto bring_up_to_date = [&]() -> Result<void> {
    const auto update = reconstructor.update();
    if (!update) return tl::unexpected<Error>(update.error());
    times.add(*update);
    return {};
  };
  for (const TrackedSlice& slice : slices) {
    const auto start = Clock::now();
    const auto added = reconstructor.add(slice);
    if (added) {
      times.cells += added->cells_ms;
      ++outcomes.of(added->outcome);
    } else {
      ++outcomes.refused;
      std::cerr << "sonoloft: plane " << slice.id << " is left out: " << added.error().message << '\n';
    }
    if (online)
      if (const auto updated = bring_up_to_date(); !updated) return tl::unexpected<Error>(updated.error());
    times.per_slice.push_back(ms_since(start));
  }
  if (!online)
    if (const auto updated = bring_up_to_date(); !updated) return tl::unexpected<Error>(updated.error());
  return outcomes;
}

Json input_json(const LoadedSlices& loaded) {
  std::size_t vertices = 0;
  std::set<Label> labels;
  for (const TrackedSlice& slice : loaded.slices) {
    std::set<std::pair<double, double>> distinct;  // contours that touch share vertices
    for (const Eigen::Vector2d& p : slice.points) distinct.emplace(p.x(), p.y());
    vertices += distinct.size();
    for (const Contour& contour : slice.contours)
      if (!contour.hole && contour.label != kUnknown && contour.label != kOutside) labels.insert(contour.label);
  }
  Json input = {{"planes", loaded.slices.size()}, {"vertices", vertices}, {"labels", labels.size()}};
  if (!loaded.frames.is_null()) input["frames"] = loaded.frames;
  return input;
}

Json report_json(const LoadedSlices& loaded, const SliceOutcomes& outcomes, const Reconstructor& r, Mesher mesher,
                 const IndexedMesh& mesh, const LabelTable& labels, const Times& t) {
  const ReconstructorCounts counts = r.counts();
  return {{"input", input_json(loaded)},
          {"slices",
           {{"inserted", outcomes.inserted},
            {"explained", outcomes.explained},
            {"merged", outcomes.merged},
            {"refused", outcomes.refused}}},
          {"cells", counts.cells},
          {"faces", counts.faces},
          {"edges", counts.edges},
          {"samples", counts.samples},
          {"leaves", counts.leaves},
          {"mesher", mesher == Mesher::live ? "live" : "delaunay"},
          {"triangles", mesh.triangles.size()},
          {"labels", labels_json(mesh, labels)},
          {"device", r.device_name()},
          {"times_ms",
           {{"load", t.load},
            {"device_start", t.device_start},
            {"cells", t.cells},
            {"completion", t.completion},
            {"slopes", t.slopes},
            {"field", t.field},
            {"octree", t.octree},
            {"mesh", t.mesh},
            {"smooth", t.smooth},
            {"delaunay", t.delaunay},
            {"total", t.total}}},
          {"per_slice_ms", json(percentiles(t.per_slice))}};
}

void print(const Json& report) {
  for (const auto& [key, value] : report.items()) std::cout << key << ": " << value << '\n';
}

Result<void> write_results(const ReconstructOptions& o, const IndexedMesh& mesh, const Json& report,
                           const LabelTable& labels, double spacing_mm) {
  print(report);
  if (auto written = write_output(mesh, o.output, labels, spacing_mm, o.compute.threads); !written) return written;
  if (o.picture)
    if (auto drawn = write_picture(mesh, labels, legend_of(mesh, labels), {}, *o.picture, o.compute.threads); !drawn)
      return drawn;
  return o.report ? write_report(report, *o.report) : Result<void>{};
}

Result<void> run_method(const ReconstructOptions& o, const LoadedSlices& loaded, const LabelTable& labels,
                        double load_ms) {
  const auto options = sized_for(o, loaded.slices);
  if (!options) return tl::unexpected<Error>(options.error());
  const auto start = Clock::now();
  const auto surfaces = reconstruct_by(o.method, loaded.slices, options->spacing_mm, o.compute.threads);
  if (!surfaces) return tl::unexpected<Error>(surfaces.error());
  const Json report{{"input", input_json(loaded)},
                    {"method", o.method.method->name},
                    {"notes", surfaces->notes},
                    {"triangles", surfaces->mesh.triangles.size()},
                    {"labels", labels_json(surfaces->mesh, labels)},
                    {"times_ms", {{"load", load_ms}, {"total", ms_since(start)}}}};
  return write_results(o, surfaces->mesh, report, labels, options->spacing_mm);
}

Result<void> run_live(const ReconstructOptions& o, const LoadedSlices& loaded, const LabelTable& labels, Times& times) {
  auto start = Clock::now();
  auto reconstructor = prepare(o, loaded.slices);
  if (!reconstructor) return tl::unexpected<Error>(reconstructor.error());
  times.device_start = ms_since(start);
  start = Clock::now();
  const auto outcomes = reconstruct(loaded.slices, o.online, *reconstructor, times);
  if (!outcomes) return tl::unexpected<Error>(outcomes.error());
  if (reconstructor->counts().triangles == 0)
    return fail(ErrorCode::empty_input, "the slices bound nothing that is a cell wide: give a larger --depth");
  const auto mesh = surfaces(*reconstructor, o.mesher, times.delaunay);
  if (!mesh) return tl::unexpected<Error>(mesh.error());
  times.total = ms_since(start);
  return write_results(o, *mesh, report_json(loaded, *outcomes, *reconstructor, o.mesher, *mesh, labels, times), labels,
                       reconstructor->samples().spacing_mm());
}

Result<void> run_reconstruct(const ReconstructOptions& o) {
  const auto labels = read_labels(o.labels);
  if (!labels) return tl::unexpected<Error>(labels.error());
  Times times;
  const auto start = Clock::now();
  const auto loaded = load_slices(o.input);
  if (!loaded) return tl::unexpected<Error>(loaded.error());
  times.load = ms_since(start);
  return o.method.method ? run_method(o, *loaded, *labels, times.load) : run_live(o, *loaded, *labels, times);
}

}  // namespace

void add_reconstruct(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("reconstruct", "Makes a mesh of recorded slices");
  auto options = std::make_shared<ReconstructOptions>();
  add_slice_input(*verb, options->input);
  add_mesh_output(*verb, options->output);
  add_labels(*verb, options->labels);
  verb->add_flag("--online", options->online, "Bring the mesh up to date after every slice, as a live scan does");
  verb->add_option("--picture", options->picture, "Draw the mesh into this PNG file")->check(ends_in(".png"));
  auto* completion = verb->add_option_function<std::string>(
                             "--completion",
                             [options](const std::string& name) {
                               options->completion =
                                   name == "published" ? Completion::published : Completion::background;
                             },
                             "What fills unknown parts of slices: background, or for comparison published (mean values "
                             "on triangles, seconds to minutes)")
                         ->check(CLI::IsMember({"background", "published"}))
                         ->default_str("background");
  verb->add_option("--hops", options->hops,
                   "With --completion published: how many unknown walls away cells are asked; default: no limit")
      ->check(CLI::Range(1, 1000))
      ->needs(completion);
  add_field(*verb, options->field);
  add_admission(*verb, options->admission);
  verb->add_option_function<std::string>(
          "--caps",
          [options](const std::string& name) {
            options->caps = name == "gap" ? Caps::gap : name == "slice" ? Caps::slice : Caps::box;
          },
          "Where a stack of parallel slices ends beyond the last ones: gap (empty one gap on: a flat end closes half "
          "way), slice (closed at the last slices) or box (nothing is assumed)")
      ->check(CLI::IsMember({"gap", "slice", "box"}))
      ->default_str("gap");
  add_mesher(*verb, options->mesher);
  add_resolution(*verb, options->resolution);
  add_compute(*verb, options->compute);
  add_method(*verb, options->method,
             {"--online", "--completion", "--field", "--admission", "--caps", "--mesher", "--device"});
  add_report(*verb, options->report);
  verb->callback([&task, options] { task = [options] { return run_reconstruct(*options); }; });
}

}  // namespace sonoloft::tool
