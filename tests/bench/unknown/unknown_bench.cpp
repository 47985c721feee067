// How well what was not measured is completed: recorded sets with a part of every slice masked, against the
// reconstruction of the whole set.  bench_unknown [--published] <depth> <seeds> <file.csl>...
#include <cmath>
#include <cstring>
#include <map>

#include "host/apps/measure/overlap.h"
#include "tests/bench/support/reconstruction.h"
#include "tests/bench/unknown/pieces.h"
#include "tests/support/masks.h"
#include "tests/support/mesh/mesh_check.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;
using test::Mask;

struct MaskKind {
  const char* name;
  Mask mask;
  double share;
  double goal;  ///< mean IoU over kMeanSets; 0: none
};
constexpr MaskKind kKinds[] = {
    {"blobs 5", Mask::blobs, 0.05, 0.985},  {"blobs 20", Mask::blobs, 0.2, 0.945},
    {"blobs 40", Mask::blobs, 0.4, 0.91},   {"half 20", Mask::half_plane, 0.2, 0.94},
    {"half 40", Mask::half_plane, 0.4, 0},  {"window 40", Mask::window, 0.4, 0.81},
    {"window 70", Mask::window, 0.7, 0.71},
};
const char* const kMeanSets[] = {"Heart-25-even-better", "Vetebrae", "eight_20", "Horsers"};

/// What completes; all but the first with --published only.
struct Way {
  const char* name;
  Completion completion;
  std::optional<int> hops;
};
constexpr Way kWays[] = {{"background", Completion::background, std::nullopt},
                         {"published", Completion::published, std::nullopt},
                         {"published, 1 hop", Completion::published, 1}};

struct Reconstruction {
  IndexedMesh mesh;
  double ms = 0;
  std::size_t cells = 0;
};

Reconstruction reconstruct(std::span<const TrackedSlice> slices, const ReconstructorOptions& options) {
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  const auto start = Clock::now();
  for (const TrackedSlice& slice : slices) or_exit(reconstructor.add(slice));
  or_exit(reconstructor.update());
  return {reconstructor.mesh().indexed(), ms_since(start), reconstructor.counts().cells};
}

/// Space of all labels in common over that of either, along 400 lines across the longer side.
double iou(const IndexedMesh& mesh, const IndexedMesh& truth) {
  constexpr double kLines = 400;
  Eigen::AlignedBox3d box;
  for (const IndexedMesh* each : {&mesh, &truth})
    for (const Eigen::Vector3f& p : each->positions) box.extend(p.cast<double>());
  const double step = std::max(box.sizes().y(), box.sizes().z()) / kLines;
  const auto ticks = [&](int axis) {
    return Ticks{box.min()[axis] + step / 2, step, static_cast<std::size_t>(box.sizes()[axis] / step) + 1};
  };
  double common = 0, either = 0;
  for (const LabelOverlap& o : scan_overlap({mesh, &truth, nullptr, {}}, {{}, ticks(1), ticks(2)}, 2).labels) {
    common += o.common_mm3;
    either += o.mesh_mm3 + o.truth_mm3 - o.common_mm3;
  }
  return common / either;
}

/// Sums over the seeds of one set.
struct Outcome {
  double iou = 0, ms = 0, pieces = 0, spurious = 0, cells = 0;
  bool closed = true;
};

Outcome measure(const MaskKind& kind, std::span<const TrackedSlice> slices, const ReconstructorOptions& options,
                const IndexedMesh& whole, std::uint64_t seeds) {
  Outcome mean;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const std::vector<TrackedSlice> input = test::masked(slices, kind.mask, kind.share, seed);
    const Reconstruction masked = reconstruct(input, options);
    const Pieces pieces = count_pieces(masked.mesh, input, options.spacing_mm);
    const double weight = 1 / static_cast<double>(seeds);
    mean.iou += weight * iou(masked.mesh, whole);
    mean.ms += weight * masked.ms;
    mean.pieces += weight * static_cast<double>(pieces.all);
    mean.spurious += weight * static_cast<double>(pieces.spurious);
    mean.cells += weight * static_cast<double>(masked.cells);
    mean.closed &= test::check_mesh(masked.mesh).closed_manifold();
  }
  return mean;
}

using Outcomes = std::map<std::string, std::map<std::string, Outcome>>;  ///< [way][mask]

Outcomes measure_set(const std::filesystem::path& file, int depth, std::uint64_t seeds, std::span<const Way> ways) {
  const std::vector<TrackedSlice> slices = read_set(file);
  ReconstructorOptions options = or_exit(options_for(slices, depth));
  options.threads = 2;
  const std::string set = file.stem().string();
  const Reconstruction whole = reconstruct(slices, options);
  const std::size_t whole_pieces = count_pieces(whole.mesh, slices, options.spacing_mm).all;
  std::fprintf(stderr, "%-22s whole: %zu pieces, %zu cells, %.1f ms\n", set.c_str(), whole_pieces, whole.cells,
               whole.ms);
  Outcomes outcomes;
  for (const Way& way : ways) {
    options.completion = way.completion;
    options.hops = way.hops;
    for (const MaskKind& kind : kKinds) {
      const Outcome o = outcomes[way.name][kind.name] = measure(kind, slices, options, whole.mesh, seeds);
      char words[200];
      std::snprintf(words, sizeof words,
                    "%-22s %-16s %-10s IoU %.4f  %5.1f pieces, %4.1f spurious (%s)  %6.0f cells  %7.1f ms  %s",
                    set.c_str(), way.name, kind.name, o.iou, o.pieces, o.spurious,
                    o.spurious <= 2 * static_cast<double>(whole_pieces) ? "reached" : "MISSED", o.cells, o.ms,
                    o.closed ? "closed" : "NOT CLOSED");
      emit({{"bench", "unknown"},
            {"set", set},
            {"depth", depth},
            {"completion", way.name},
            {"mask", kind.name},
            {"iou", o.iou},
            {"pieces", o.pieces},
            {"spurious_pieces", o.spurious},
            {"whole_pieces", whole_pieces},
            {"closed", o.closed},
            {"cells", o.cells},
            {"total_ms", o.ms}},
           words);
    }
  }
  return outcomes;
}

void print_means(const std::map<std::string, Outcomes>& sets, std::span<const Way> ways) {
  for (const char* set : kMeanSets)
    if (!sets.contains(set)) return;
  std::fprintf(stderr, "\nmean over Heart, Vertebrae, eight_20, Horsers\n");
  for (const Way& way : ways)
    for (const MaskKind& kind : kKinds) {
      double mean = 0;
      for (const char* set : kMeanSets)
        mean += sets.at(set).at(way.name).at(kind.name).iou / static_cast<double>(std::size(kMeanSets));
      std::fprintf(stderr, "%-16s %-10s IoU %.4f", way.name, kind.name, mean);
      if (way.completion == Completion::background && kind.goal > 0)
        std::fprintf(stderr, "  goal %.3f  %s", kind.goal, mean >= kind.goal ? "reached" : "MISSED");
      std::fprintf(stderr, "\n");
    }
}

}  // namespace

int main(int argc, char** argv) {
  const int first = argc > 1 && std::strcmp(argv[1], "--published") == 0 ? 2 : 1;
  if (argc < first + 3) {
    std::fprintf(stderr, "usage: bench_unknown [--published] <depth> <seeds> <file.csl>...\n");
    return 2;
  }
  const std::span<const Way> ways = std::span(kWays).first(first == 2 ? std::size(kWays) : 1);
  std::map<std::string, Outcomes> sets;
  for (int i = first + 2; i < argc; ++i) {
    const std::filesystem::path file = argv[i];
    const std::uint64_t seeds = std::strtoull(argv[first + 1], nullptr, 10);
    sets[file.stem().string()] = measure_set(file, std::atoi(argv[first]), seeds, ways);
  }
  print_means(sets, ways);
}
