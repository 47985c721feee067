// The live mesh of a recorded set and the Delaunay mesh of the same field at the same resolution, in one process and on
// one thread, and how good each is.  bench_delaunay <file.csl> <depth>
#include <algorithm>

#include "core/offline/delaunay_mesher.h"
#include "tests/bench/set/zero_set.h"
#include "tests/bench/support/reconstruction.h"
#include "tests/support/mesh/contour_distance.h"
#include "tests/support/mesh/mesh_check.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

/// Angles, and distances between the mesh and the zero set, both ways, in finest cells.
/// @param points_mm  on the zero set
/// @param other      stands for the zero set where none lies along a normal
nlohmann::json quality(const IndexedMesh& mesh, const ZeroSet& seen, std::span<const Eigen::Vector3d> points_mm,
                       const IndexedMesh& other, double cell_mm) {
  const std::vector<double> angles = test::smallest_angles_deg(mesh);
  std::vector<double> away = seen.distances_mm;
  for (const double distance : test::distances(seen.missed_mm, other)) away.push_back(distance);
  const std::vector<double> back = test::distances(points_mm, mesh);
  return {{"smallest_angle_p5_deg", quantile(angles, 0.05)},
          {"smallest_angle_p50_deg", quantile(angles, 0.5)},
          {"to_zero_set_p50_cells", quantile(away, 0.5) / cell_mm},
          {"to_zero_set_p99_cells", quantile(away, 0.99) / cell_mm},
          {"from_zero_set_p99_cells", quantile(back, 0.99) / cell_mm},
          {"hausdorff_cells", std::max(quantile(away, 1), quantile(back, 1)) / cell_mm}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_delaunay <file.csl> <depth>\n");
    return 2;
  }
  const std::filesystem::path file = argv[1];
  const int depth = std::atoi(argv[2]);
  const std::vector<TrackedSlice> slices = read_set(file);
  const ReconstructorOptions options = or_exit(options_for(slices, depth));
  const Batch live = median_batch(slices, options, 3);

  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  for (const TrackedSlice& slice : slices) or_exit(reconstructor.add(slice));
  or_exit(reconstructor.update());
  const DelaunayMesh delaunay = or_exit(
      delaunay_mesh(reconstructor.samples(), reconstructor.mesh(), DelaunayCriteria::like_live(options.spacing_mm)));
  const IndexedMesh shown = reconstructor.mesh().indexed();
  const ZeroSet of_live = zero_set(reconstructor.samples(), reconstructor.mesh(), shown),
                of_delaunay = zero_set(reconstructor.samples(), reconstructor.mesh(), delaunay.mesh);
  std::vector<Eigen::Vector3d> points_mm = of_live.points_mm;
  points_mm.insert(points_mm.end(), of_delaunay.points_mm.begin(), of_delaunay.points_mm.end());
  const double ratio = delaunay.ms / live.times.total_ms;
  char words[200];
  std::snprintf(words, sizeof words, "Delaunay mesh of %s, depth %d: %.1f s, %.0f times as long as the live mesh",
                file.stem().c_str(), depth, delaunay.ms * 1e-3, ratio);
  emit({{"bench", "delaunay"},
        {"set", file.stem().string()},
        {"depth", depth},
        {"live_ms", live.times.total_ms},
        {"live_triangles", live.counts.triangles},
        {"live_quality", quality(shown, of_live, points_mm, delaunay.mesh, options.spacing_mm)},
        {"delaunay_ms", delaunay.ms},
        {"delaunay_triangles", delaunay.mesh.triangles.size()},
        {"delaunay_quality", quality(delaunay.mesh, of_delaunay, points_mm, shown, options.spacing_mm)},
        {"ratio", ratio}},
       words);
}
