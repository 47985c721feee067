#include "device_sim/probe/phantoms/recorded_planes.h"

#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "device_sim/probe/simulated_probe.h"
#include "tests/support/phantom_section.h"

namespace test = sonoloft::test;
using namespace sonoloft::device_sim;

namespace {

/// An L of area 3 s^2: no symmetry hides a wrong turn.
PhantomSection letter(double s, Label label) {
  return {{{0, 0}, {2 * s, 0}, {2 * s, s}, {s, s}, {s, 2 * s}, {0, 2 * s}}, {{0, 6, label, false}}};
}

std::vector<RecordedPlane> three_planes() {
  return {{test::plane_at({5, 6, 1000}, {0, 0, 1}), letter(10, 1)},
          {test::plane_at({5, 6, 1003}, {1, 0, 5}), letter(11, 2)},
          {test::plane_at({-5, 6, 1009}, {1, -2, 3}), {}}};
}

}  // namespace

TEST_CASE("recording: every recorded plane gives back its own points, seen from any frame in that plane") {
  const auto recorded = RecordedPlanes::make(three_planes());
  REQUIRE(recorded.value);
  const auto& planes = three_planes();
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Isometry3d asked = planes[i].plane_to_reference * Eigen::Translation3d(3, -4, 0) *
                                    Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ());
    const PhantomSection section = recorded.value->section(asked);
    REQUIRE(section.points.size() == 6);
    CHECK(section.loops[0].label == i + 1);
    for (std::size_t k = 0; k < 6; ++k) {
      const Eigen::Vector2d &got = section.points[k], &put = planes[i].section.points[k];
      CHECK((asked * Eigen::Vector3d(got.x(), got.y(), 0) -
             planes[i].plane_to_reference * Eigen::Vector3d(put.x(), put.y(), 0))
                .norm() < 1e-9);
    }
  }
  CHECK(recorded.value->section(planes[2].plane_to_reference).loops.empty());
  CHECK(recorded.value->section(test::plane_at({5, 6, 1001}, {0, 0, 1})).loops.empty());
  CHECK(recorded.value->section(test::plane_at({5, 6, 1000}, {0, 0.001, 1})).loops.empty());
}

TEST_CASE("recording: what was seen of a plane is played back with it") {
  std::vector<RecordedPlane> planes = three_planes();
  planes[1].section.field_of_view = {{-1, -1}, {15, -1}, {-1, 15}};
  std::shared_ptr<const RecordedPlanes> recorded = RecordedPlanes::make(planes).value;
  auto probe = SimulatedProbe::make({}, recorded, recorded->trajectory());
  REQUIRE(probe.value);
  CHECK(probe.value->next()->field_of_view.empty());
  const auto frame = probe.value->next();
  REQUIRE(frame->field_of_view.size() == 3);
  CHECK(0.2f * frame->field_of_view[1].x_px == doctest::Approx(15));
  CHECK(0.2f * frame->field_of_view[1].y_px == doctest::Approx(-1));
}

TEST_CASE("recording: a probe without a sector plays it back plane by plane, empty ones too") {
  std::shared_ptr<const RecordedPlanes> recorded = RecordedPlanes::make(three_planes()).value;
  auto probe = SimulatedProbe::make({}, recorded, recorded->trajectory());
  REQUIRE(probe.value);
  const std::size_t counts[] = {6, 6, 0};
  for (const std::size_t count : counts) {
    const auto frame = probe.value->next();
    REQUIRE(frame);
    CHECK(frame->points.size() == count);
    CHECK(frame->field_of_view.empty());
  }
  CHECK(!probe.value->next());
}

TEST_CASE("recording: planes that make no sense are refused and say why") {
  const auto refused = [](std::vector<RecordedPlane> planes, const char* word) {
    const auto made = RecordedPlanes::make(std::move(planes));
    INFO(made.error);
    CHECK(!made.value);
    CHECK(made.error.find(word) != std::string::npos);
  };
  refused({}, "no plane has a contour");
  std::vector<RecordedPlane> bad = three_planes();
  bad[1].plane_to_reference.linear() *= 2;
  refused(bad, "plane 1 has a pose that is not rigid");
  bad = three_planes();
  bad[0].section.points[3].x() = std::numeric_limits<double>::infinity();
  refused(bad, "not a finite number");
  bad = three_planes();
  bad[0].section.points.pop_back();
  refused(bad, "without a loop");
  bad = three_planes();
  bad[0].section.loops[0].count = 2;
  refused(bad, "3 points or more");
}
