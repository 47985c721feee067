// What one method makes of one set, the live one beside the others: how near to the truth and to the contours, whether
// closed, how large and how late.  bench_methods <file.csl|pelvis> <depth> <method|live> [truth.stl]
#include <algorithm>
#include <sstream>

#include "core/io/meshes/mesh_files.h"
#include "core/methods/catalogue.h"
#include "host/apps/measure/measure.h"
#include "tests/bench/methods/pelvis.h"
#include "tests/bench/support/reconstruction.h"
#include "tests/support/mesh/contour_distance.h"
#include "tests/support/mesh/mesh_check.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

constexpr int kThreads = 2;

Result<IndexedMesh> live_mesh(std::span<const TrackedSlice> slices, ReconstructorOptions options) {
  options.threads = kThreads;
  options.device = DeviceChoice::cpu;
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  for (const TrackedSlice& slice : slices) or_exit(reconstructor.add(slice));
  or_exit(reconstructor.update());
  return reconstructor.mesh().indexed();
}

Result<IndexedMesh> mesh_by(const std::string& name, std::span<const TrackedSlice> slices,
                            const ReconstructorOptions& options) {
  if (name == "live") return live_mesh(slices, options);
  const Method* method = find_method(name);
  if (method == nullptr) return fail(ErrorCode::invalid_argument, "no method " + name);
  auto surfaces = method->run({slices, options.spacing_mm, kThreads, or_exit(settings_of(*method, {}))});
  if (!surfaces) return tl::unexpected<Error>(surfaces.error());
  return std::move(surfaces->mesh);
}

void add_quality(nlohmann::json& figures, std::span<const TrackedSlice> slices, const IndexedMesh& mesh,
                 double spacing_mm) {
  const std::vector<double> distances = test::contour_distances(slices, mesh);
  const test::MeshReport report = test::check_mesh(mesh);
  figures["manifold"] = report.closed_manifold();
  figures["closed"] = std::ranges::all_of(report.labels, [](const auto& label) {
    return label.second.boundary_edges + label.second.misoriented_edges == 0;
  });
  figures["contour_p95_cells"] = quantile(distances, 0.95) / spacing_mm;
  figures["contour_max_cells"] = quantile(distances, 1) / spacing_mm;
}

void add_truth(nlohmann::json& figures, const IndexedMesh& mesh, const std::filesystem::path& path) {
  const Comparison of = or_exit(measure_against_mesh(mesh, or_exit(read_mesh(path)), kThreads));
  figures["iou"] = of.overlaps.front().iou();
  figures["mean_percent"] = 100 * of.surface.mean_mm / of.truth_diagonal_mm;
  figures["max_percent"] = 100 * of.surface.max_mm / of.truth_diagonal_mm;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4 || argc > 5) {
    std::fprintf(stderr, "usage: bench_methods <file.csl|pelvis> <depth> <method|live> [truth.stl]\n");
    return 2;
  }
  const std::filesystem::path file = argv[1];
  const std::string method = argv[3];
  const std::vector<TrackedSlice> slices = file == "pelvis" ? pelvis() : read_set(file);
  ReconstructorOptions options = or_exit(options_for(slices, std::atoi(argv[2])));
  if (file == "pelvis") options.spacing_mm = 1;

  nlohmann::json figures{
      {"bench", "methods"}, {"set", file.stem().string()}, {"depth", std::atoi(argv[2])}, {"method", method}};
  const auto start = Clock::now();
  const auto mesh = mesh_by(method, slices, options);
  figures["ms"] = ms_since(start);
  figures["peak_memory_mib"] = peak_memory_mib();
  if (!mesh) {
    figures["refused"] = mesh.error().message;
  } else {
    figures["triangles"] = mesh->triangles.size();
    add_quality(figures, slices, *mesh, options.spacing_mm);
    if (argc == 5) add_truth(figures, *mesh, argv[4]);
  }
  std::ostringstream words;
  words << method << " of " << figures["set"] << ": " << (mesh ? "measured" : "refused");
  emit(figures, words.str());
}
