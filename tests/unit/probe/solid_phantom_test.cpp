#include "device_sim/probe/phantoms/solid_phantom.h"

#include <doctest/doctest.h>

#include <numbers>
#include <set>
#include <utility>

#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

constexpr double kPi = std::numbers::pi;

/// The total length of the edges that two loops run along, one each way.
double shared_length(const PhantomSection& section, const SectionLoop& one, const SectionLoop& other) {
  using Edge = std::pair<std::pair<double, double>, std::pair<double, double>>;
  const auto edges = [&](const SectionLoop& loop, bool reversed) {
    std::set<Edge> set;
    const auto p = test::points_of(section, loop);
    for (std::size_t i = 0; i < p.size(); ++i) {
      std::pair a(p[i].x(), p[i].y()), b(p[(i + 1) % p.size()].x(), p[(i + 1) % p.size()].y());
      set.insert(reversed ? Edge(b, a) : Edge(a, b));
    }
    return set;
  };
  double length = 0;
  const std::set<Edge> there = edges(other, true);
  for (const Edge& e : edges(one, false))
    if (there.contains(e)) length += std::hypot(e.second.first - e.first.first, e.second.second - e.first.second);
  return length;
}

const SectionLoop* loop_of(const PhantomSection& section, Label label) {
  for (const SectionLoop& loop : section.loops)
    if (loop.label == label) return &loop;
  return nullptr;
}

}  // namespace

TEST_CASE("solids: the section of a sphere has the area of its circle") {
  const SolidPhantom phantom({sphere({3, -2, 5}, 40, 7)});
  for (const double d : {0.0, 10.0, -25.0, 35.0, 39.0}) {
    const Eigen::Vector3d normal = Eigen::Vector3d(1, 2, -0.5).normalized();
    const PhantomSection section = phantom.section(test::plane_at(Eigen::Vector3d(3, -2, 5) + d * normal, normal));
    REQUIRE(section.loops.size() == 1);
    CHECK(test::well_formed(section));
    CHECK(section.loops[0].label == 7);
    const double area = test::loop_area(section.points), exact = kPi * (1600 - d * d);
    INFO("distance " << d << ": area " << area << ", exact " << exact);
    CHECK(std::abs(area / exact - 1) < 1e-3);
  }
  CHECK(phantom.section(test::plane_at({3, -2, 46}, {0, 0, 1})).loops.empty());
}

TEST_CASE("solids: points of a contour lie on the sphere to less than a micrometre") {
  const SolidPhantom phantom({sphere({0, 0, 0}, 40, 1)});
  const Eigen::Isometry3d cut = test::plane_at({5, 6, 7}, {1, 1, 3});
  const PhantomSection section = phantom.section(cut);
  double worst = 0;
  for (const Eigen::Vector2d& p : section.points)
    worst = std::max(worst, std::abs((cut * Eigen::Vector3d(p.x(), p.y(), 0)).norm() - 40));
  MESSAGE("largest distance from the sphere: " << worst << " mm");
  CHECK(section.points.size() > 100);
  CHECK(worst < 1e-3);
}

TEST_CASE("solids: each shape has its volume") {
  const Eigen::Isometry3d turned(Eigen::Translation3d(1, 2, 3) *
                                 Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -1, 2).normalized()));
  const std::pair<Solid, double> cases[] = {
      {ellipsoid(turned, {30, 20, 10}, 1), 4.0 / 3 * kPi * 6000},
      {box(turned, {30, 20, 10}, 1), 8.0 * 6000},
      {capsule({-20, 5, 0}, {20, 5, 10}, 8, 1), kPi * 64 * std::hypot(40, 10) + 4.0 / 3 * kPi * 512},
      {torus(turned, 25, 6, 1), 2 * kPi * kPi * 25 * 36},
  };
  for (const auto& [solid, volume_mm3] : cases) {
    const double exact = volume_mm3;
    const auto shape = static_cast<int>(solid.shape);
    const SolidPhantom phantom({solid});
    const Eigen::AlignedBox3d bounds = phantom.bounds();
    constexpr int kPlanes = 60;
    const double step = bounds.sizes().z() / kPlanes;
    double volume = 0;
    for (int i = 0; i < kPlanes; ++i) {
      const PhantomSection section =
          phantom.section(test::plane_at({0, 0, bounds.min().z() + (i + 0.5) * step}, {0, 0, 1}));
      CHECK(test::well_formed(section));
      for (const SectionLoop& loop : section.loops)
        volume += (loop.hole ? -1 : 1) * step * test::loop_area(test::points_of(section, loop));
    }
    INFO("shape " << shape << ": volume " << volume << ", exact " << exact);
    CHECK(std::abs(volume / exact - 1) < 2e-3);
  }
}

TEST_CASE("solids: two organs that touch share their border point by point") {
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()));
  // The second one is laid over the first: they meet in the plane x = 0 of the turned frame, 40 x 60 mm.
  const SolidPhantom phantom(
      {box(turned, {50, 20, 30}, 1), box(turned * Eigen::Translation3d(25, 0, 0), {25, 20, 30}, 2)});
  const Eigen::Isometry3d cut = turned * Eigen::Translation3d(0, 0, 4);
  const PhantomSection section = phantom.section(cut);
  REQUIRE(section.loops.size() == 2);
  CHECK(test::well_formed(section));
  const double shared = shared_length(section, section.loops[0], section.loops[1]);
  MESSAGE("shared " << shared << " mm of 40 mm");
  CHECK(shared == doctest::Approx(40).epsilon(2 * phantom.spacing_mm() / 40));
  CHECK(test::label_area(section, 1) == doctest::Approx(2000).epsilon(1e-3));
  CHECK(test::label_area(section, 2) == doctest::Approx(2000).epsilon(1e-3));
}

TEST_CASE("solids: three organs meet in one point that all three contours have") {
  const auto quarter = [](double x, double y, Label label) {
    return box(Eigen::Isometry3d(Eigen::Translation3d(x, y, 0)), {20, 20, 20}, label);
  };
  const SolidPhantom phantom({quarter(-17.3, -17.1, 1), quarter(22.7, -17.1, 2), quarter(3.1, 22.9, 3)});
  const PhantomSection section = phantom.section(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 1)));
  REQUIRE(section.loops.size() == 3);
  const Eigen::Vector2d exact(2.7, 2.9);
  std::vector<Eigen::Vector2d> nearest;
  for (const SectionLoop& loop : section.loops) {
    const auto points = test::points_of(section, loop);
    nearest.push_back(*std::min_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      return (a - exact).norm() < (b - exact).norm();
    }));
  }
  CHECK(nearest[0] == nearest[1]);
  CHECK(nearest[0] == nearest[2]);
  MESSAGE("junction found to " << (nearest[0] - exact).norm() << " mm");
  CHECK((nearest[0] - exact).norm() < 1e-3);
}

TEST_CASE("solids: a cavity is a hole, and an island in it a contour again") {
  const SolidPhantom phantom({sphere({0, 0, 0}, 40, 1), sphere({0, 0, 0}, 25, kOutside), sphere({3, 0, 0}, 10, 2)});
  const PhantomSection section = phantom.section(test::plane_at({0, 0, 0}, {0, 1, 1}));
  REQUIRE(section.loops.size() == 3);
  CHECK(test::well_formed(section));
  CHECK(loop_of(section, kOutside)->hole);
  CHECK(test::label_area(section, 1) == doctest::Approx(kPi * (1600 - 625)).epsilon(1e-3));
  CHECK(test::label_area(section, 2) == doctest::Approx(kPi * 100).epsilon(1e-3));
}

TEST_CASE("organs: five labels, of which liver and kidney touch and the tumour lies in the liver") {
  const SolidPhantom phantom = organs_phantom();
  const Eigen::AlignedBox3d bounds = phantom.bounds();
  std::set<Label> seen;
  double liver_kidney = 0;
  for (int i = 0; i < 40; ++i) {
    const double x = bounds.min().x() + (i + 0.5) / 40 * bounds.sizes().x();
    const PhantomSection section = phantom.section(test::plane_at({x, 0, 0}, {1, 0, 0}));
    CHECK(test::well_formed(section));
    for (const SectionLoop& loop : section.loops) seen.insert(loop.label);
    const SectionLoop *liver = loop_of(section, static_cast<Label>(Organ::liver)),
                      *kidney = loop_of(section, static_cast<Label>(Organ::kidney));
    if (liver && kidney) liver_kidney += shared_length(section, *liver, *kidney);
  }
  CHECK(seen == std::set<Label>{0, 1, 2, 3, 4, 5});
  MESSAGE("liver and kidney share " << liver_kidney << " mm of border in 40 sections");
  CHECK(liver_kidney > 100);
}
