// What a page is told of how sure the mesh is and of what was seen, when it asks.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <numbers>
#include <set>
#include <thread>

#include "tests/integration/view/scene_client.h"
#include "tests/integration/view/view_support.h"

using namespace sonoloft;
using namespace sonoloft::test;

TEST_CASE("view: how sure the surface is and how far from a slice comes when asked for, and grows old nowhere") {
  std::atomic<float> share = 0.5F, distance_mm = 7.2F;
  std::atomic<int> questions = 0;
  view::ViewSource source;
  source.confidence = [&](std::span<const Eigen::Vector3f> points) {
    ++questions;
    return Confidence{std::vector<float>(points.size(), share), std::vector<float>(points.size(), distance_mm)};
  };
  const auto server = open_server(std::move(source));
  if (!server) return;
  const auto updates = ball_updates(24);
  server->show(updates.back());
  SceneClient viewer(port_of(*server));
  const auto all_are = [](const SceneMessage& message, int measured, int quarters_mm) {
    for (const auto& [coord, surfaces] : message.bricks)
      for (const auto& [label, surface] : surfaces)
        for (std::size_t v = 0; v < surface.shades.size(); ++v)
          if (surface.shades[v][3] != measured || surface.distances[v] != quarters_mm) return false;
    return true;
  };
  CHECK(all_are(viewer.catch_up(), 127, 0));
  viewer.say("measured");
  const SceneMessage asked = viewer.catch_up();
  CHECK(asked.bricks.size() == updates.back()->mesh.chunks.size());
  CHECK(all_are(asked, 64, 29));
  CHECK(questions == 1);
  share = 1;
  distance_mm = 1000;
  server->show(updates.back());  // the same mesh, after slices that did not change it
  std::set<BrickCoord> renewed;
  while (renewed.size() < asked.bricks.size()) {
    const SceneMessage message = viewer.catch_up();
    CHECK(all_are(message, 127, 255));
    for (const auto& [coord, surfaces] : message.bricks) renewed.insert(coord);
  }
}

TEST_CASE("view: what was seen comes when it is asked for, and the scan is asked for no more than a part of its time") {
  using Clock = std::chrono::steady_clock;
  std::atomic<int> asked = 0;
  std::array<Clock::time_point, 2> begins, ends;
  view::ViewSource source;
  source.coverage = [&] {
    const std::size_t answer = std::min(asked.load(), 1);
    begins[answer] = Clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ends[answer] = Clock::now();
    Coverage coverage;
    coverage.volume_mm3 = 4000 + 1000 * ++asked;
    coverage.seen_mm3 = 2500;
    coverage.near_mm = 3;
    CoverageGap& gap = coverage.largest_gap.emplace();
    gap.volume_mm3 = 1500;
    gap.suggested_image_to_reference.linear() =
        Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).matrix();
    gap.suggested_image_to_reference.translation() = Eigen::Vector3d(1, 2, 3);
    return coverage;
  };
  const auto server = open_server(std::move(source));
  if (!server) return;
  SceneClient viewer(port_of(*server));
  const auto ask = [&] {
    viewer.say("coverage");
    return viewer.catch_up().head["coverage"];
  };
  CHECK(ask().is_null());  // nothing was scanned
  const auto updates = ball_updates(24);
  server->show(updates.back());
  CHECK(!viewer.catch_up().head.contains("coverage"));
  const nlohmann::json coverage = ask();
  CHECK(coverage["volume_ml"] == 5);
  CHECK(coverage["seen"] == 0.5);
  CHECK(coverage["near_mm"] == 3);
  CHECK(coverage["gap"]["volume_ml"] == 1.5);
  CHECK(coverage["gap"]["centre"] == nlohmann::json{1, 2, 3});
  CHECK(coverage["gap"]["normal"][1].get<double>() == doctest::Approx(-1));
  CHECK(ask() == coverage);
  CHECK(asked == 1);  // the mesh is the same
  int questions = 0;
  for (std::size_t next = 0; asked == 1; ++questions, ++next) {
    server->show(updates[next % updates.size()]);
    const nlohmann::json answer = ask();
    CHECK(answer["volume_ml"] == 4 + asked);
  }
  MESSAGE(questions << " questions until the scan was asked again");
  CHECK(begins[1] - ends[0] >= 20 * (ends[0] - begins[0]));
}
