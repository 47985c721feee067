#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "core/io/meshes/mesh_files.h"
#include "core/methods/catalogue.h"
#include "core/methods/equal_importance/contour_blend.h"
#include "core/methods/metamorphosis/contour_morph.h"
#include "tests/support/mesh/contour_distance.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/recorded_slices.h"
#include "tests/support/stacks/covered_overlap.h"
#include "tests/support/stacks/slice_crease.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

struct Recorded {
  std::vector<TrackedSlice> slices;
  SliceStack stack;
  double spacing_mm;  ///< as at depth 8
};

std::optional<Recorded> recorded(const std::string& name) {
  auto file = read_recorded_slices("csl/" + name + ".csl");
  if (!file) return std::nullopt;
  auto stack = make_stack(file->slices, "test");
  REQUIRE(stack);
  const double height_mm = stack->heights_mm.back() - stack->heights_mm.front();
  const double spacing_mm = 1.1 * std::max(stack->bounds.sizes().maxCoeff(), height_mm) / 256;
  return Recorded{std::move(file->slices), std::move(*stack), spacing_mm};
}

MethodSurfaces run(const std::string& method, const Recorded& set) {
  auto settings = settings_of(*find_method(method), {});
  auto surfaces = find_method(method)->run({set.slices, set.spacing_mm, 2, *settings});
  if (!surfaces) FAIL(surfaces.error().message);
  return std::move(*surfaces);
}

double mean_crease_deg(const LayeredField& field, const SliceStack& stack) {
  const std::vector<double> creases = creases_deg(field, stack);
  return std::accumulate(creases.begin(), creases.end(), 0.0) / static_cast<double>(creases.size());
}

}  // namespace

TEST_CASE("methods: recorded stacks come out closed, in one piece and on their contours") {
  struct Expected {
    std::string name;
    long genus;
  };
  for (const Expected& expected : {Expected{"eight_15", 2}, Expected{"hand_ok", 1}, Expected{"ParallelEight", 2}}) {
    const auto set = recorded(expected.name);
    if (!set) continue;
    for (const std::string method : {"equal-importance", "metamorphosis"}) {
      CAPTURE(expected.name);
      CAPTURE(method);
      const IndexedMesh mesh = run(method, *set).mesh;
      const MeshReport report = check_mesh(mesh);
      CHECK_MESSAGE(report.closed_manifold(), report.text());
      CHECK(report.labels.at(1).components == 1);
      CHECK(report.labels.at(1).genus() == expected.genus);
      std::vector<double> distances = contour_distances(set->slices, mesh);
      std::ranges::sort(distances);
      const double p95 = distances[distances.size() * 95 / 100] / set->spacing_mm,
                   most = distances.back() / set->spacing_mm;
      MESSAGE(expected.name, ", ", method, ": contours are off by ", p95, " cells at 95 %, at most ", most);
      CHECK(p95 < 0.1);
      CHECK(most < (method == "metamorphosis" ? 0.5 : 1.0));
    }
  }
}

TEST_CASE("methods: what recorded stacks enclose between their slices is that of the true body") {
  struct Expected {
    std::string name, truth;
    double morph, blend;
  };
  for (const Expected& expected : {Expected{"eight_15", "truth/eight_20_scaled.stl", 0.965, 0.93},
                                   Expected{"hand_ok", "truth/hand_ok_scaled.stl", 0.963, 0.95}}) {
    const auto set = recorded(expected.name);
    const auto path = recorded_set(expected.truth);
    if (!set || !path) continue;
    const auto truth = read_mesh(*path);
    REQUIRE(truth);
    const double morph = covered_iou(set->stack, run("metamorphosis", *set).mesh, *truth),
                 blend = covered_iou(set->stack, run("equal-importance", *set).mesh, *truth);
    MESSAGE(expected.name, ": IoU between the slices: metamorphosis ", morph, ", equal-importance ", blend);
    CHECK(morph > expected.morph);
    CHECK(blend > expected.blend);
  }
}

TEST_CASE("methods: metamorphosis runs through recorded slices without a crease") {
  const auto set = recorded("eight_15");
  if (!set) return;
  const auto chart = chart_of(set->slices, "test");
  REQUIRE(chart);
  const double smooth = mean_crease_deg(ContourMorph(set->stack, {set->spacing_mm, StackEnds::round, 2}), set->stack),
               linear = mean_crease_deg(ContourBlend(*chart, {set->spacing_mm}), set->stack);
  MESSAGE("eight_15: mean crease ", smooth, " degrees, of the linear morph ", linear);
  CHECK(smooth < 2);
  CHECK(linear > 10);
}
