// How good the live mesh of a recorded set is: the shape of its triangles, how near it keeps to the contours, and
// whether it is closed, manifold and free of crossings.  bench_quality <file.csl> <depth>
#include "tests/bench/support/reconstruction.h"
#include "tests/support/mesh/contour_distance.h"
#include "tests/support/mesh/mesh_check.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

IndexedMesh mesh_of(std::span<const TrackedSlice> slices, ReconstructorOptions options) {
  options.threads = 2;
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  for (const TrackedSlice& slice : slices) or_exit(reconstructor.add(slice));
  or_exit(reconstructor.update());
  return reconstructor.mesh().indexed();
}

/// Edges and vertices at which the boundary of some label is not a closed manifold.
std::size_t manifold_faults(const test::MeshReport& report) {
  std::size_t count = 0;
  for (const auto& [label, of] : report.labels)
    count += of.boundary_edges + of.non_manifold_edges + of.misoriented_edges + of.non_manifold_vertices;
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_quality <file.csl> <depth>\n");
    return 2;
  }
  const std::filesystem::path file = argv[1];
  const int depth = std::atoi(argv[2]);
  const std::vector<TrackedSlice> slices = read_set(file);
  const ReconstructorOptions options = or_exit(options_for(slices, depth));
  const IndexedMesh mesh = mesh_of(slices, options);
  const std::vector<double> angles = test::smallest_angles_deg(mesh);
  const std::vector<double> distances = test::contour_distances(slices, mesh);
  const test::MeshReport report = test::check_mesh(mesh);
  nlohmann::json crossings;  // null where triangles without an area leave the question open
  if (report.degenerate_triangles == 0) crossings = test::count_self_intersections(mesh);

  const nlohmann::json figures{
      {"bench", "quality"},
      {"set", file.stem().string()},
      {"depth", depth},
      {"triangles", mesh.triangles.size()},
      {"smallest_angle_p5_deg", quantile(angles, 0.05)},
      {"smallest_angle_p50_deg", quantile(angles, 0.5)},
      {"contour_points", distances.size()},
      {"contour_distance_p50_cells", quantile(distances, 0.5) / options.spacing_mm},
      {"contour_distance_p95_cells", quantile(distances, 0.95) / options.spacing_mm},
      {"manifold_faults", manifold_faults(report)},
      {"degenerate_triangles", report.degenerate_triangles},
      {"self_intersections", crossings},
  };
  emit(figures, "quality of " + file.stem().string() + ", depth " + std::to_string(depth) + ": measured");
}
