#include "core/tracking/pose_track.h"

#include <doctest/doctest.h>

using namespace sonoloft;
using namespace std::chrono_literals;

namespace {

Eigen::Isometry3d turned(double angle, double x_mm) {
  return Eigen::Translation3d(x_mm, 0, 0) * Eigen::AngleAxisd(angle, Eigen::Vector3d(2, -1, 2) / 3);
}

bool near(const std::optional<Eigen::Isometry3d>& pose, const Eigen::Isometry3d& expected) {
  return pose && (pose->matrix() - expected.matrix()).cwiseAbs().maxCoeff() < 1e-12;
}

}  // namespace

TEST_CASE("pose track: between two poses the rotation turns evenly about one axis, the position goes straight") {
  PoseTrack track;
  track.add(100ms, turned(0, 0));
  track.add(200ms, turned(2, 10));
  CHECK(near(track.at(100ms), turned(0, 0)));
  CHECK(near(track.at(200ms), turned(2, 10)));
  for (int i = 1; i < 10; ++i) CHECK(near(track.at(100ms + i * 10ms), turned(0.2 * i, i)));
}

TEST_CASE("pose track: the short way round, whichever sign a quaternion has") {
  PoseTrack track;
  track.add(0ms, turned(3, 0));
  track.add(10ms, turned(3.4, 0));  // beyond half a turn the quaternion's sign may flip
  CHECK(near(track.at(5ms), turned(3.2, 0)));
}

TEST_CASE("pose track: no pose is invented") {
  PoseTrack track(50ms);
  CHECK_FALSE(track.at(0ms));
  CHECK_FALSE(track.newest());
  track.add(0ms, turned(0, 0));
  track.add(20ms, turned(0, 1));
  track.add(40ms, std::nullopt);
  track.add(60ms, turned(0, 3));
  track.add(80ms, turned(0, 4));
  track.add(180ms, turned(0, 9));
  CHECK_FALSE(track.at(-1ms));
  CHECK(track.at(10ms));
  for (const auto t : {21ms, 40ms, 59ms}) CHECK_FALSE(track.at(t));  // next to a dropout
  CHECK(track.at(70ms));
  CHECK_FALSE(track.at(130ms));  // longer than the longest gap
  CHECK(track.at(180ms));
  CHECK_FALSE(track.at(181ms));
  CHECK(*track.newest() == 180ms);
}

TEST_CASE("pose track: a pose that is no newer than the last one is not taken") {
  PoseTrack track;
  track.add(10ms, turned(0, 1));
  track.add(10ms, turned(0, 2));
  track.add(5ms, turned(0, 3));
  CHECK(near(track.at(10ms), turned(0, 1)));
}

TEST_CASE("pose track: what is forgotten is not needed for later times") {
  PoseTrack track;
  for (int i = 0; i < 100; ++i) track.add(i * 10ms, turned(0.01 * i, i));
  track.forget_before(505ms);
  CHECK_FALSE(track.at(495ms));
  CHECK(near(track.at(505ms), turned(0.505, 50.5)));
}
