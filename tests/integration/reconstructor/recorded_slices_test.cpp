#include "tests/support/recorded_slices.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "core/reconstructor/reconstructor.h"
#include "core/slice/section.h"
#include "tests/support/mesh/contour_distance.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/mesh/mesh_labels.h"

using namespace sonoloft;

namespace {

constexpr int kDepth = 7;

double distance_to_contours(const Section& section, const Eigen::Vector2d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const SectionEdge& e : section.edges) {
    const Eigen::Vector2d a = section.points[e.a];
    const Eigen::Vector2d d = section.points[e.b] - a;
    const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (p - a - t * d).squaredNorm());
  }
  return std::sqrt(best);
}

struct Agreement {
  std::size_t points = 0, agree = 0;
};

/// Compares the mesh with the slices at random points of each slice's contours' box, away from contours.
Agreement compare(const test::MeshLabels& labels, std::span<const TrackedSlice> slices, double clearance_mm) {
  Agreement result;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const TrackedSlice& slice : slices) {
    const auto section = make_section(slice);
    REQUIRE(section);
    if (section->edges.empty()) continue;
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : section->points) box.extend(p);
    for (int i = 0; i < 400; ++i) {
      const Eigen::Vector2d p = box.min() + box.sizes().cwiseProduct(Eigen::Vector2d(uniform(rng), uniform(rng)));
      if (distance_to_contours(*section, p) <= clearance_mm) continue;
      ++result.points;
      result.agree +=
          labels.at(section->image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0.0)) == label_at(*section, p);
    }
  }
  return result;
}

}  // namespace

TEST_CASE("reconstructor: every recorded set gives closed 2-manifolds that do not cross and agree with their slices") {
  for (const std::string name : test::kRecordedSlices) {
    const auto file = test::read_recorded_slices(name);
    if (!file) continue;  // printed as skipped
    CAPTURE(name);
    auto options = options_for(file->slices, kDepth);
    REQUIRE(options);
    options->device = DeviceChoice::cpu;
    options->threads = 2;
    auto reconstructor = Reconstructor::create(*options);
    REQUIRE(reconstructor);
    std::set<Label> given;
    for (const TrackedSlice& slice : file->slices) {
      REQUIRE(reconstructor->add(slice));
      const auto section = make_section(slice);
      REQUIRE(section);
      for (const SectionEdge& e : section->edges) given.insert({e.left, e.right});
    }
    REQUIRE(reconstructor->update());
    const IndexedMesh mesh = reconstructor->mesh().indexed();

    const test::MeshReport report = test::check_mesh(mesh);
    CHECK_MESSAGE(report.closed_manifold(), report.text());
    std::set<Label> drawn;
    for (const auto& [label, unused] : report.labels) drawn.insert(label);
    CHECK(drawn == given);
    const std::size_t crossing = test::count_self_intersections(mesh);
    CHECK(crossing == 0);
    const Agreement agreement = compare(test::MeshLabels(mesh), file->slices, 1.5 * options->spacing_mm);
    const double share = static_cast<double>(agreement.agree) / static_cast<double>(agreement.points);
    CHECK(share >= 0.995);
    std::vector<double> distance = test::contour_distances(file->slices, mesh);
    std::sort(distance.begin(), distance.end());
    const auto in_cells = [&](double share_of_points) {
      return distance[static_cast<std::size_t>(share_of_points * static_cast<double>(distance.size() - 1))] /
             options->spacing_mm;
    };
    CHECK(in_cells(0.5) <= 0.02);
    CHECK(in_cells(0.95) <= 0.5);  // 0.25 a depth finer: what is left lies where the mesh is coarser than the contours
    MESSAGE(name << ": contour points are ", in_cells(0.5), " finest cells away in the median, 95 % at most ",
            in_cells(0.95));
    MESSAGE(name << ": " << mesh.triangles.size() << " triangles, " << crossing << " self-intersections, "
                 << agreement.points << " points on slices agree to " << 100.0 * share << " %");
  }
}
