#include "core/tracking/time_offset.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/tracking/bottom_line.h"

using namespace sonoloft;
using namespace std::chrono_literals;

namespace {

using Ns = std::chrono::nanoseconds;

double way_mm(Ns t) {
  const double s = static_cast<double>(t.count()) * 1e-9;
  return 12 * std::sin(6 * s) + 5 * std::sin(2.3 * s);
}

PoseTrack track_of(double amplitude) {
  PoseTrack track;
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  for (int i = 0; i < 800; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(300, 20, -7) + amplitude * way_mm(i * 25ms) * axis;
    track.add(i * 25ms, pose);
  }
  return track;
}

std::vector<TimedValue> seen_at(Ns offset, double noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> error(0, noise);
  std::vector<TimedValue> seen;
  for (Ns t = 1s; t < 18s; t += 87ms) seen.push_back({t, 250 - 7 * way_mm(t + offset) + error(random)});
  return seen;
}

}  // namespace

TEST_CASE("time offset: the lag between images and poses is found, whichever way the image counts") {
  const PoseTrack track = track_of(1);
  for (const Ns offset : {Ns(-64'800us), Ns(0), Ns(31'300us), Ns(400ms)}) {
    const auto found = estimate_time_offset(seen_at(offset, 5), track);
    REQUIRE(found);
    CHECK(std::abs((found->offset - offset).count()) < 2'000'000);
    CHECK(found->correlation > 0.95);
  }
}

TEST_CASE("time offset: what cannot be judged is refused with a reason") {
  const auto seen = seen_at(0ms, 5);
  const auto few = estimate_time_offset(std::span(seen).first(19), track_of(1));
  REQUIRE_FALSE(few);
  CHECK(few.error().code == ErrorCode::empty_input);
  const auto rested = estimate_time_offset(seen, track_of(0.01));
  REQUIRE_FALSE(rested);
  CHECK(rested.error().message.find("rested") != std::string::npos);
  const auto unrelated = estimate_time_offset(seen_at(0ms, 500), track_of(1));
  REQUIRE_FALSE(unrelated);
  CHECK(unrelated.error().code == ErrorCode::invalid_argument);
}

TEST_CASE("bottom line: the brightest line is found in speckle, and none where there is none") {
  ImageStack images;
  images.dims = {120, 200, 3};
  images.pixels.assign(120 * 200 * 3, 0);
  std::mt19937 random(5);
  for (std::size_t i = 0; i < 2 * 120 * 200; ++i) images.pixels[i] = static_cast<std::uint8_t>(random() % 60);
  for (std::size_t x = 0; x < 120; ++x) {
    for (std::size_t y = 79 + x / 30; y < 86 + x / 30; ++y) images.pixels[y * 120 + x] = 200;  // a little slanted
  }
  const auto lines = bottom_lines(images);
  REQUIRE(lines.size() == 3);
  REQUIRE(lines[0]);
  CHECK(*lines[0] == doctest::Approx(84).epsilon(0.02));
  CHECK_FALSE(lines[1]);  // speckle only
  CHECK_FALSE(lines[2]);  // dark
}
