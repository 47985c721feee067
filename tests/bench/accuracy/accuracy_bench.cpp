// How near the reconstruction comes to what the slices were cut from, with either field.
//   bench_accuracy <depth> [part of a name]...     without one: all cases
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "host/apps/measure/accuracy.h"
#include "tests/bench/accuracy/cases.h"
#include "tests/bench/support/reconstruction.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

constexpr int kThreads = 2;

IndexedMesh mesh_of(std::span<const TrackedSlice> slices, ReconstructorOptions options, FieldMethod field) {
  options.field = field;
  options.admission = Admission::everything;
  options.threads = kThreads;
  Reconstructor reconstructor = or_exit(Reconstructor::create(options));
  for (const TrackedSlice& slice : slices) or_exit(reconstructor.add(slice));
  or_exit(reconstructor.update());
  return reconstructor.mesh().indexed();
}

Accuracy measure(const Case& c, const IndexedMesh& mesh) {
  TrueBody truth{c.surface};
  if (c.body) truth.label_at = [&](const Eigen::Vector3d& p) { return Label{c.body->label_at(p)}; };
  return or_exit(measure_accuracy(mesh, c.slices, truth, kThreads));
}

nlohmann::json json(const Accuracy& a) {
  nlohmann::json figures = nlohmann::json::object();
  for (const auto& [name, value] : figures_of(a)) figures[name] = value;
  for (const LabelAgreement& label : a.agreement.labels)
    figures["iou_of_labels"][std::to_string(label.label)] = label.iou();
  return figures;
}

std::string words(const Accuracy& a) {
  char text[400];
  const auto& quartiles = a.passage.turn_quartiles_deg;
  std::snprintf(
      text, sizeof text,
      "IoU %.4f  wrong %.4f  mean %.3f %%  max %5.2f %%  pieces %zu (%zu large) of %zu (%zu)  genus %ld of %ld  "
      "crease %4.1f (turn %.1f, quartiles %.1f %.1f %.1f, truth %.1f; along %.1f, truth %.1f)  lean %4.1f",
      a.agreement.mean_iou(), a.agreement.mislabelled, 100 * a.distance.mean_mm / a.diagonal_mm,
      100 * a.distance.max_mm / a.diagonal_mm, a.pieces.all, a.pieces.large, a.truth_pieces.all, a.truth_pieces.large,
      a.pieces.genus, a.truth_pieces.genus, a.passage.crease_deg, a.passage.turn_deg, quartiles[0], quartiles[1],
      quartiles[2], a.passage.truth_turn_deg, a.passage.along_deg, a.passage.truth_along_deg, a.passage.lean_deg);
  return text;
}

/// Sums of one group at one noise with one field.
struct Sum {
  double iou = 0, mislabelled = 0, crease_deg = 0;
  int cases = 0;
};
using Sums = std::map<std::tuple<std::string, double, std::string>, Sum>;

void measure_case(const NamedCase& named, const Case& c, int depth, Sums& sums) {
  const ReconstructorOptions options = or_exit(options_for(c.slices, depth));
  for (const auto& [name, field] : {std::pair("step", FieldMethod::step), std::pair("smooth", FieldMethod::smooth)}) {
    const auto start = Clock::now();
    const IndexedMesh mesh = mesh_of(c.slices, options, field);
    const double ms = ms_since(start);
    const Accuracy a = measure(c, mesh);
    Sum& sum = sums[{named.group, named.noise, name}];
    sum.iou += a.agreement.mean_iou();
    sum.mislabelled += a.agreement.mislabelled;
    sum.crease_deg += a.passage.crease_deg;
    ++sum.cases;
    nlohmann::json figures = json(a);
    figures.update({{"bench", "accuracy"},
                    {"group", named.group},
                    {"set", named.set},
                    {"planes", named.planes},
                    {"count", c.slices.size()},
                    {"noise_percent", named.noise},
                    {"seed", named.seed},
                    {"field", name},
                    {"depth", depth},
                    {"triangles", mesh.triangles.size()},
                    {"ms", ms}});
    char head[200];
    std::snprintf(head, sizeof head, "%-44s %-6s ", named.name().c_str(), name);
    emit(figures, head + words(a));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_accuracy <depth> [part of a name]...\n");
    return 2;
  }
  Sums sums;
  for (const NamedCase& named : all_cases()) {
    const auto asked = [&](const char* part) { return named.name().find(part) != std::string::npos; };
    if (argc > 2 && std::none_of(argv + 2, argv + argc, asked)) continue;
    if (const auto c = named.make()) measure_case(named, *c, std::atoi(argv[1]), sums);
  }
  for (const auto& [key, sum] : sums)
    std::fprintf(stderr, "mean of %-9s noise %-4g %% %-6s  IoU %.4f  wrong %.4f  crease %.1f  (%d)\n",
                 std::get<0>(key).c_str(), std::get<1>(key), std::get<2>(key).c_str(), sum.iou / sum.cases,
                 sum.mislabelled / sum.cases, sum.crease_deg / sum.cases, sum.cases);
}
