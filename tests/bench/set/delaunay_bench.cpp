// The live mesh of a recorded set and the Delaunay mesh of the same field at the same resolution, in one process and on
// one thread.  bench_delaunay <file.csl> <depth>
#include "core/offline/delaunay_mesher.h"
#include "tests/bench/support/reconstruction.h"

int main(int argc, char** argv) {
  using namespace sonoloft;
  using namespace sonoloft::bench;
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
  const double ratio = delaunay.ms / live.times.total_ms;
  char words[200];
  std::snprintf(words, sizeof words, "Delaunay mesh of %s, depth %d: %.1f s, %.0f times as long as the live mesh",
                file.stem().c_str(), depth, delaunay.ms * 1e-3, ratio);
  emit({{"bench", "delaunay"},
        {"set", file.stem().string()},
        {"depth", depth},
        {"live_ms", live.times.total_ms},
        {"live_triangles", live.counts.triangles},
        {"delaunay_ms", delaunay.ms},
        {"delaunay_triangles", delaunay.mesh.triangles.size()},
        {"ratio", ratio}},
       words);
}
