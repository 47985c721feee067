// A live scan of the liver slice by slice, the mesh brought up to date after each:
// bench_sweep passes|still <slices> [depth] [everything]
#include <cmath>
#include <cstring>
#include <map>

#include "core/io/volumes/label_volume.h"
#include "device_sim/probe/phantoms/volume_phantom.h"
#include "host/apps/measure/measure.h"
#include "tests/bench/support/reconstruction.h"
#include "tests/support/live_scan.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;
namespace sim = device_sim;

constexpr double kDeep_mm = 20, kBox_mm = 260;

/// Grey values of the file, by volume.
const std::map<Label, Label> kLabelOfGrey = {{0, 0}, {255, 1}, {127, 2}, {85, 3}, {84, 0}};

LabelVolume liver_volume() {
  const char* folder = std::getenv("SONOLOFT_DATA");
  const std::filesystem::path file = std::filesystem::path(folder ? folder : "build/data") / "liver.inr.gz";
  if (!std::filesystem::exists(file)) {
    std::fprintf(stderr, "SKIP: %s is absent; './run demo' unpacks it\n", file.c_str());
    std::exit(0);
  }
  LabelVolume volume = or_exit(read_inr(file));
  for (Label& label : volume.labels) label = kLabelOfGrey.at(label);
  return volume;
}

std::shared_ptr<const sim::Phantom> phantom_of(const LabelVolume& volume) {
  const Eigen::Vector3i dims(static_cast<int>(volume.dims[0]), static_cast<int>(volume.dims[1]),
                             static_cast<int>(volume.dims[2]));
  return sim::VolumePhantom::make(dims, volume.spacing_mm, volume.origin_mm, volume.labels).value;
}

/// Voxels of 1.5 mm around the known part of the slices, with the label that the body has there; 0 elsewhere.
struct Scanned {
  LabelVolume truth;
  std::vector<bool> seen;  ///< [#voxels]
};

Scanned scanned_part(const sim::Phantom& body, std::span<const TrackedSlice> slices) {
  constexpr double kVoxel_mm = 1.5;
  const Eigen::AlignedBox3d bounds = body.bounds();
  Scanned scanned;
  scanned.truth.spacing_mm.setConstant(kVoxel_mm);
  scanned.truth.origin_mm = bounds.min();
  const Eigen::Vector3i dims = (bounds.sizes() / kVoxel_mm).array().ceil().cast<int>();
  const auto index = [&](const Eigen::Vector3i& v) {
    return static_cast<std::size_t>(v.x() + dims.x() * (v.y() + dims.y() * v.z()));
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    scanned.truth.dims[axis] = static_cast<std::uint32_t>(dims[static_cast<int>(axis)]);
  scanned.truth.labels.assign(static_cast<std::size_t>(dims.prod()), kOutside);
  scanned.seen.assign(scanned.truth.labels.size(), false);
  for (const TrackedSlice& slice : slices) {
    Eigen::AlignedBox2d view;
    for (const Eigen::Vector2d& p : slice.field_of_view) view.extend(p);
    for (double y = view.min().y(); y < view.max().y(); y += kVoxel_mm / 2)
      for (double x = view.min().x(); x < view.max().x(); x += kVoxel_mm / 2) {
        if (!sim::encloses(slice.field_of_view, {x, y})) continue;
        const Eigen::Vector3d at = slice.image_to_reference * Eigen::Vector3d(x, y, 0);
        const Eigen::Vector3i v = ((at - bounds.min()) / kVoxel_mm).array().round().cast<int>();
        if ((v.array() < 0).any() || (v.array() >= dims.array()).any() || scanned.seen[index(v)]) continue;
        scanned.seen[index(v)] = true;
        scanned.truth.labels[index(v)] = body.label_at(bounds.min() + kVoxel_mm * v.cast<double>());
      }
  }
  return scanned;
}

const LabelOverlap* overlap_of(const Comparison& comparison, Label label) {
  for (const LabelOverlap& overlap : comparison.overlaps)
    if (overlap.label == label) return &overlap;
  return nullptr;
}

/// Dice of a label where something was scanned, counted in voxels; null where the body does not have it there.
nlohmann::json dice(const IndexedMesh& mesh, const Scanned& scanned, Label label) {
  LabelVolume all = scanned.truth;
  for (std::size_t i = 0; i < all.labels.size(); ++i) all.labels[i] = scanned.seen[i] ? label : kOutside;
  const Comparison truth = or_exit(measure_against_volume(mesh, scanned.truth, 2));
  const Comparison seen = or_exit(measure_against_volume(mesh, all, 2));
  const LabelOverlap *a = overlap_of(truth, label), *b = overlap_of(seen, label);
  if (!a || a->truth_mm3 == 0) return nullptr;
  return 2 * a->common_mm3 / ((b ? b->common_mm3 : 0) + a->truth_mm3);
}

/// Over the slices [first, end).
nlohmann::json cost(const std::vector<double>& ms, std::size_t first, std::size_t end) {
  if (end > ms.size() || first >= end) return nullptr;
  const std::vector<double> part(ms.begin() + static_cast<std::ptrdiff_t>(first),
                                 ms.begin() + static_cast<std::ptrdiff_t>(end));
  return {{"p50", quantile(part, 0.5)}, {"p95", quantile(part, 0.95)}, {"max", quantile(part, 1)}};
}

/// How late the mesh of the latest slice would be if every slice had one, at 20 Hz. (A session joins what waits.)
double longest_wait_ms(const std::vector<double>& slice_ms) {
  constexpr double kPeriod_ms = 50;
  double late = 0, longest = 0;
  for (const double ms : slice_ms) {
    late = std::max(0.0, late - kPeriod_ms) + ms;
    longest = std::max(longest, late);
  }
  return longest;
}

struct Run {
  std::vector<double> add_ms, slice_ms;  ///< [#slices] insertion; insertion and update
  std::size_t cut = 0;                   ///< slices that cut a cell
  IndexedMesh mesh;
  ReconstructorCounts counts;
};

Run run(std::span<const TrackedSlice> slices, const ReconstructorOptions& options) {
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  Run run;
  for (const TrackedSlice& slice : slices) {
    const auto start = Clock::now();
    run.cut += or_exit(reconstructor.add(slice)).cells_cut > 0;
    run.add_ms.push_back(ms_since(start));
    // What cuts everywhere is too much for a mesh after every slice: its last one is compared.
    const bool last = &slice == &slices.back();
    if (last || options.admission == Admission::news) or_exit(reconstructor.update());
    run.slice_ms.push_back(ms_since(start));
    if (run.slice_ms.size() % 100 == 0)
      std::fprintf(stderr, "  %zu slices: %zu cells, this one %.1f ms\n", run.slice_ms.size(),
                   reconstructor.counts().cells, run.slice_ms.back());
  }
  run.mesh = reconstructor.mesh().indexed();
  run.counts = reconstructor.counts();
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  const bool passes = argc >= 3 && std::strcmp(argv[1], "passes") == 0;
  if (argc < 3 || (!passes && std::strcmp(argv[1], "still") != 0)) {
    std::fprintf(stderr, "usage: bench_sweep passes|still <slices> [depth] [everything]\n");
    return 2;
  }
  const auto count = static_cast<std::uint32_t>(std::atoi(argv[2]));
  const int depth = argc > 3 ? std::atoi(argv[3]) : 7;
  const auto liver = phantom_of(liver_volume());
  const auto trajectory =
      passes ? test::live_passes(*liver, count, kDeep_mm, 1) : test::live_standstill(*liver, count, kDeep_mm, 1);
  const auto start = Clock::now();
  const std::vector<TrackedSlice> slices = test::live_scan(liver, trajectory, test::live_probe(1));
  std::fprintf(stderr, "simulated in %.2f ms a slice\n", ms_since(start) / count);

  ReconstructorOptions options;
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(kBox_mm / 2);
  options.box = {liver->bounds().center() - half, liver->bounds().center() + half};
  options.spacing_mm = 1.1 * liver->bounds().sizes().maxCoeff() / std::exp2(depth);
  options.threads = 2;
  if (argc > 4 && std::strcmp(argv[4], "everything") == 0) options.admission = Admission::everything;
  const Run done = run(slices, options);
  const Scanned scanned = scanned_part(*liver, slices);

  const std::size_t n = slices.size();
  nlohmann::json figures{{"bench", "sweep"},
                         {"sweep", argv[1]},
                         {"slices", n},
                         {"spacing_mm", options.spacing_mm},
                         {"counts", done.counts},
                         {"slices_that_cut", done.cut},
                         {"add_ms_50_to_150", cost(done.add_ms, 50, 150)},
                         {"add_ms_last_100", cost(done.add_ms, n - std::min<std::size_t>(n, 100), n)},
                         {"slice_ms_50_to_150", cost(done.slice_ms, 50, 150)},
                         {"slice_ms_last_100", cost(done.slice_ms, n - std::min<std::size_t>(n, 100), n)},
                         {"longest_wait_ms_at_20_hz", longest_wait_ms(done.slice_ms)},
                         {"peak_memory_mib", peak_memory_mib()}};
  for (const Label label : {Label{1}, Label{2}, Label{3}})
    figures["dice_where_scanned"][std::to_string(label)] = dice(done.mesh, scanned, label);
  emit(figures, figures.dump(1));
}
