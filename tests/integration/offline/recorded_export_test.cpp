#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/offline/delaunay_mesher.h"
#include "core/reconstructor/reconstructor.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/recorded_slices.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

struct Export {
  IndexedMesh live, refined;
  double spacing_mm;
};

Export export_of(std::span<const TrackedSlice> slices, int depth) {
  auto options = options_for(slices, depth);
  REQUIRE(options);
  options->device = DeviceChoice::cpu;
  auto reconstructor = Reconstructor::create(*options);
  REQUIRE(reconstructor);
  for (const TrackedSlice& slice : slices) (void)reconstructor->add(slice);  // a slice left out is not the subject
  REQUIRE(reconstructor->update());
  const MeshSnapshot live = reconstructor->mesh();
  auto refined = delaunay_mesh(reconstructor->samples(), live, DelaunayCriteria::like_live(options->spacing_mm));
  if (!refined) FAIL(refined.error().message);
  return {live.indexed(), std::move(refined->mesh), options->spacing_mm};
}

using Cube = std::array<int, 3>;
Cube cube_of(const Eigen::Vector3f& p, double edge_mm) {
  const auto at = [&](int a) { return static_cast<int>(std::floor(static_cast<double>(p[a]) / edge_mm)); };
  return {at(0), at(1), at(2)};
}

/// Vertices of `from` with no vertex of `to` within three spacings. The same pieces of surface, or this is not 0: on
/// the corner of a contour, a vertex may lie a finest cell's diagonal off the surface of the samples, and vertices of
/// `to` are more than a spacing apart.
std::size_t far_vertices(const IndexedMesh& from, const IndexedMesh& to, double spacing_mm) {
  std::map<Cube, std::vector<Eigen::Vector3f>> near;
  const double reach_mm = 3 * spacing_mm;
  for (const Eigen::Vector3f& p : to.positions) near[cube_of(p, reach_mm)].push_back(p);
  const auto has_near = [&](const Eigen::Vector3f& p) {
    const Cube c = cube_of(p, reach_mm);
    for (int i = 0; i < 27; ++i) {
      const auto at = near.find({c[0] + i % 3 - 1, c[1] + i / 3 % 3 - 1, c[2] + i / 9 - 1});
      if (at == near.end()) continue;
      for (const Eigen::Vector3f& q : at->second)
        if (static_cast<double>((p - q).norm()) < reach_mm) return true;
    }
    return false;
  };
  return static_cast<std::size_t>(std::ranges::count_if(from.positions, [&](const auto& p) { return !has_near(p); }));
}

}  // namespace

TEST_CASE("offline: every recorded set is meshed whole, closed and manifold for every label") {
  for (const std::string name : kRecordedSlices) {
    const auto file = read_recorded_slices(name);
    if (!file) continue;
    CAPTURE(name);
    const Export mesh = export_of(file->slices, name == "csl/Vetebrae.csl" ? 6 : 5);
    const MeshReport live = check_mesh(mesh.live), report = check_mesh(mesh.refined);
    CHECK_MESSAGE(report.closed_manifold(), report.text());
    CHECK(count_self_intersections(mesh.refined) == 0);
    const auto angles = smallest_angles_deg(mesh.refined);
    const auto below_30 = std::ranges::lower_bound(angles, 29.9) - angles.begin();
    CHECK(below_30 <= std::ssize(angles) / 1000);
    for (const auto& [label, of_live] : live.labels) CHECK(report.labels.contains(label));
    const std::size_t lost = far_vertices(mesh.live, mesh.refined, mesh.spacing_mm);
    CHECK(lost == 0);
    MESSAGE(name, ": ", report.labels.size() - 1, " labels, ", mesh.refined.triangles.size(), " triangles, live ",
            mesh.live.triangles.size(), "; smallest angle 5 % ", angles[angles.size() / 20], " median ",
            angles[angles.size() / 2], " deg, ", below_30, " below 30; ", lost, " live vertices far from it");
  }
}
