// The yardstick itself: what planes cut out of bodies given by formulas.
#include "tests/support/bodies/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "core/slice/section.h"
#include "tests/support/bodies/cut.h"
#include "tests/support/bodies/plane_sets.h"
#include "tests/support/bodies/true_surface.h"
#include "tests/support/mesh/mesh_check.h"
#include "tests/support/phantom_section.h"

using namespace sonoloft;
using namespace sonoloft::test;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;

NamedBody body_named(const std::string& name) {
  for (NamedBody& body : bodies_of_one_label())
    if (body.name == name) return body;
  FAIL("no body ", name);
  return {};
}

/// Of the regions with this label, by the edges that have it on one side: left of an edge counts, right counts against.
double area_of(const Section& section, Label label) {
  double twice = 0;
  for (const SectionEdge& edge : section.edges) {
    const Vector2d &a = section.points[edge.a], &b = section.points[edge.b];
    twice += ((edge.left == label) - (edge.right == label)) * (a.x() * b.y() - a.y() * b.x());
  }
  return twice / 2;
}

Vector3d in_space(const Section& section, const Vector2d& p) {
  return section.image_to_reference * Vector3d(p.x(), p.y(), 0);
}

/// Edges whose labels are not those of the body a little to the left and to the right of their middles.
std::size_t wrong_edges(const Section& section, const device_sim::Phantom& body, double aside_mm) {
  std::size_t wrong = 0;
  for (const SectionEdge& edge : section.edges) {
    const Vector2d &a = section.points[edge.a], &b = section.points[edge.b];
    const Vector2d aside = aside_mm * Vector2d(a.y() - b.y(), b.x() - a.x()).normalized();
    wrong += body.label_at(in_space(section, (a + b) / 2 + aside)) != edge.left ||
             body.label_at(in_space(section, (a + b) / 2 - aside)) != edge.right;
  }
  return wrong;
}

}  // namespace

TEST_CASE("bodies: the contours of a sphere have the areas of circles") {
  const NamedBody sphere = body_named("sphere");
  for (const double d : {0.0, 17.0, -33.0}) {
    const Vector3d normal = Vector3d(1, -2, 0.5).normalized();
    const auto section = make_section(cut(*sphere.body, plane_at(d * normal, normal), 0));
    REQUIRE(section);
    CHECK(area_of(*section, 1) / (kPi * (1600 - d * d)) == doctest::Approx(1).epsilon(1e-3));
  }
}

TEST_CASE("bodies: stacks of contours have the volumes of their bodies") {
  const double tube_mm3 = kPi * 13 * 13 * 2 * kPi * 34;
  const std::pair<const char*, double> volumes[] = {{"ellipsoid", 4.0 / 3 * kPi * 50 * 32 * 20},
                                                    {"torus", tube_mm3},
                                                    {"cone", kPi * 34 * 34 * 80 / 3},
                                                    {"oblique cylinder", kPi * 20 * 20 * 80},
                                                    {"thin slab", 92.0 * 68 * 8}};
  constexpr int kPlanes = 60;
  for (const auto& [name, volume_mm3] : volumes) {
    const NamedBody named = body_named(name);
    const Eigen::AlignedBox3d box = named.body->bounds();
    const double step = box.sizes().x() / kPlanes;
    double sum = 0;
    for (int i = 0; i < kPlanes; ++i) {
      const Vector3d middle(box.min().x() + (i + 0.5) * step, 0, 0);
      const auto section = make_section(cut(*named.body, plane_at(middle, Vector3d::UnitX()), 0));
      REQUIRE(section);
      CHECK(section->repaired_crossings == 0);
      sum += step * area_of(*section, 1);
    }
    MESSAGE(std::string(name), ": ", sum, " mm3 of ", volume_mm3);
    CHECK(sum / volume_mm3 == doctest::Approx(1).epsilon(2e-3));
  }
}

TEST_CASE("bodies: every edge has the body's labels on its left and on its right, at junctions too") {
  const NamedBody three = body_of_three_labels();
  const IndexedMesh surface = true_surface(*three.body);
  std::size_t edges = 0, wrong = 0, junctions = 0, slices_with_junctions = 0, slices = 0;
  for (const NamedPlaneSet& planes : kPlaneSets) {
    for (const TrackedSlice& slice : cut(*three.body, make_planes(planes.set, 12, surface.positions, 3))) {
      const auto section = make_section(slice);
      REQUIRE(section);
      if (section->edges.empty()) continue;
      std::vector<int> degree(section->points.size());
      for (const SectionEdge& edge : section->edges) ++degree[edge.a], ++degree[edge.b];
      const auto here = std::count_if(degree.begin(), degree.end(), [](int d) { return d == 3; });
      junctions += static_cast<std::size_t>(here);
      slices_with_junctions += here > 0;
      ++slices;
      edges += section->edges.size();
      wrong += wrong_edges(*section, *three.body, 1e-2);
    }
  }
  MESSAGE(junctions, " junctions in ", slices_with_junctions, " of ", slices, " slices; ", wrong, " of ", edges,
          " edges are wrong");
  CHECK(wrong <= 3 * junctions);  // those that meet there run through a square of the grid, not along the border
  CHECK(wrong * 100 < edges);
  CHECK(slices_with_junctions * 2 > slices);
}

TEST_CASE("bodies: noise moves points by its standard deviation, shared points together, and is the same again") {
  const NamedBody three = body_of_three_labels();
  const auto planes = std::vector{plane_at({1, 2, 3}, {0.2, 0.3, 1})};
  const std::vector<TrackedSlice> exact = cut(*three.body, planes);
  const std::vector<TrackedSlice> noisy = with_noise(exact, 0.7, 5);
  CHECK(with_noise(exact, 0.7, 5)[0].points == noisy[0].points);
  CHECK(with_noise(exact, 0.7, 6)[0].points != noisy[0].points);
  double squares = 0;
  std::set<std::pair<double, double>> before, after;
  for (std::size_t i = 0; i < exact[0].points.size(); ++i) {
    const Vector2d &p = exact[0].points[i], &q = noisy[0].points[i];
    squares += (q - p).squaredNorm() / 2;
    before.insert({p.x(), p.y()});
    after.insert({q.x(), q.y()});
  }
  const double deviation = std::sqrt(squares / static_cast<double>(exact[0].points.size()));
  MESSAGE(before.size(), " points, standard deviation ", deviation);
  CHECK(before.size() < exact[0].points.size());
  CHECK(after.size() == before.size());
  CHECK(deviation == doctest::Approx(0.7).epsilon(0.1));
}

TEST_CASE("bodies: surfaces are closed, have the volumes of their bodies and lie on their borders") {
  for (const auto& [name, volume_mm3, genus] :
       {std::tuple("sphere", 4.0 / 3 * kPi * 64000, 0), std::tuple("torus", kPi * 169 * 2 * kPi * 34, 1)}) {
    const NamedBody named = body_named(name);
    const MeshReport report = check_mesh(true_surface(*named.body));
    REQUIRE(report.closed_manifold());
    CHECK(report.labels.at(1).genus() == genus);
    MESSAGE(std::string(name), ": ", report.labels.at(1).volume_mm3, " mm3 of ", volume_mm3);
    CHECK(report.labels.at(1).volume_mm3 / volume_mm3 == doctest::Approx(1).epsilon(2e-3));
  }
  double worst = 0;
  for (const Eigen::Vector3f& p : true_surface(*body_named("sphere").body).positions)
    worst = std::max(worst, std::abs(p.cast<double>().norm() - 40));
  MESSAGE("farthest vertex from the sphere: ", worst, " mm");
  CHECK(worst < 0.1);  // a fifth of the lattice's step
}

TEST_CASE("bodies: every set of planes has as many planes as asked for, most of which cut the body") {
  const NamedBody cone = body_named("cone");
  const IndexedMesh surface = true_surface(*cone.body);
  for (const NamedPlaneSet& named : kPlaneSets) {
    const auto planes = make_planes(named.set, 20, surface.positions, 1);
    REQUIRE(planes.size() == 20);
    std::size_t cutting = 0;
    for (const TrackedSlice& slice : cut(*cone.body, planes)) cutting += !slice.contours.empty();
    MESSAGE(std::string(named.name), ": ", cutting, " of 20 planes cut");
    CHECK(cutting >= 18);
  }
}
