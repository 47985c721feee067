// The page in a browser: what it shows, what its keys do, what it takes of memory.
#include <doctest/doctest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "host/record/recording_transport.h"
#include "host/record/replay/replay_transport.h"
#include "tests/integration/view/browser.h"
#include "tests/integration/view/scene_client.h"
#include "tests/integration/view/view_support.h"
#include "tests/support/temporary_folder.h"

using namespace sonoloft;
using namespace sonoloft::test;
namespace fs = std::filesystem;

namespace {

void wait_for_viewers(const view::ViewServer& server, std::size_t count, const std::future<int>& browser) {
  while (server.figures().viewers < count && !done(browser)) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

/// Records a scan of the ball.
void record_ball(const fs::path& file, std::uint32_t slices, double rate_hz) {
  device_sim::LoopbackOptions options = ball_device_options();
  options.rate_hz = rate_hz;
  device_sim::LoopbackDevice device(options, ball_source(slices));
  auto recorder = record::Recorder::create(file);
  REQUIRE(recorder);
  const auto scan = ScanSession::open(std::make_unique<record::RecordingTransport>(
                                          std::make_unique<device::LoopbackTransport>(device.port()), *recorder),
                                      ball_scan_options());
  REQUIRE(scan);
  ScanInbox inbox;
  REQUIRE((*scan)->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  (*scan)->stop();
  REQUIRE((*recorder)->close());
}

/// Replays a recording as fast as it was made. @return how many meshes the server was shown
std::size_t show_replay(const fs::path& file, view::ViewServer& server) {
  auto replay = record::ReplayTransport::open(file, 1);
  REQUIRE(replay);
  const auto scan = ScanSession::open(std::move(*replay), ball_scan_options());
  REQUIRE(scan);
  ScanInbox inbox;
  ScanCallbacks callbacks = inbox.callbacks();
  callbacks.on_mesh = [&server, keep = callbacks.on_mesh](std::shared_ptr<const MeshUpdate> update) {
    server.show(update);
    keep(std::move(update));
  };
  callbacks.on_slice = [&server](std::shared_ptr<const device::DeliveredSlice> slice) {
    server.show(std::move(slice));
  };
  REQUIRE((*scan)->start(callbacks));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  (*scan)->stop();
  return inbox.updates().size();
}

void check_in_step(const nlohmann::json& counts) {
  CHECK(counts["bricksReceived"] == counts["bricksSent"]);
  CHECK(counts["bricks"] == counts["serverBricks"]);
  CHECK(counts["faces"] == counts["serverFaces"]);
  CHECK(counts["faces"] > 1000);
}

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  std::size_t total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

double since_epoch_ms(std::chrono::system_clock::time_point at) {
  return std::chrono::duration<double, std::milli>(at.time_since_epoch()).count();
}

}  // namespace

TEST_CASE("view: the page follows a scan, late pages catch up, keys do what they say") {
  if (!browser_is_there()) return;
  constexpr std::uint32_t kSlices = 60;
  constexpr double kGap_mm3 = 2345;
  device_sim::LoopbackOptions device_options = ball_device_options();
  device_options.rate_hz = 20;
  device_sim::LoopbackDevice device(device_options, ball_source(kSlices));
  ScanOptions options = ball_scan_options();
  options.stream.mode = device::StreamMode::live;
  const auto scan = open_scan(device.port(), options);
  std::atomic<bool> stopped = false;
  view::ViewSource source;
  source.confidence = [&](std::span<const Eigen::Vector3f> points) { return scan->confidence(points); };
  source.coverage = [&] {
    Coverage coverage = scan->coverage();
    CoverageGap& gap = coverage.largest_gap.emplace();  // which a ball seen all over has not
    gap.volume_mm3 = kGap_mm3;
    gap.suggested_image_to_reference.translation() = Eigen::Vector3d(10, 20, 30);
    return coverage;
  };
  source.ledger = [&] { return scan->ledger(); };
  source.stop = [&] { stopped = true; };
  const auto server = open_server(std::move(source));
  if (!server) return;

  auto browser = drive(server->url(), "scan");
  wait_for_viewers(*server, 1, browser);
  std::atomic<double> first_slice_ms = 0;
  ScanInbox inbox([&](const MeshUpdate&) {});
  ScanCallbacks callbacks = inbox.callbacks();
  callbacks.on_mesh = [&, then = callbacks.on_mesh](std::shared_ptr<const MeshUpdate> update) {
    server->show(update);
    then(update);
  };
  callbacks.on_slice = [&](std::shared_ptr<const device::DeliveredSlice> slice) {
    if (first_slice_ms == 0) first_slice_ms = since_epoch_ms(std::chrono::system_clock::now());
    server->show(slice);
  };
  REQUIRE(scan->start(callbacks));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  server->show("the scan is over", true);
  while (!stopped && !done(browser)) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  server->show("stopped");

  REQUIRE(browser.get() == 0);
  const nlohmann::json report = report_of("scan");
  MESSAGE("first mesh on the page " << report["first"]["firstMeshAt"].get<double>() - first_slice_ms
                                    << " ms after the first slice; " << report["first"].dump());
  CHECK(report["errors"].empty());
  check_in_step(report["first"]);
  for (const auto& late : report["late"]) check_in_step(late);
  for (const auto& key : report["keys"].items()) {
    const std::string name = key.key();
    CAPTURE(name);
    CHECK((!key.value().is_boolean() || key.value().get<bool>()));
  }
  CHECK(report["keys"]["first"] == "first point");
  CHECK(report["keys"]["second"] == "second point");
  const std::string distance = report["keys"]["distance"];
  CHECK(distance.ends_with(" mm"));  // between two points of the ball, 15 degrees apart
  CHECK(std::stod(distance) == doctest::Approx(2 * kBallRadius_mm * std::sin(std::numbers::pi / 24)).epsilon(0.1));
  for (const char* page : {"coverage", "touched"}) {
    const nlohmann::json told = report[page];
    MESSAGE(told.dump());
    CHECK(told["text"].get<std::string>().ends_with(" ml seen. The disc shows 2.345 ml that no slice came near."));
    CHECK(told["far"] == "≥ 20 mm");
    CHECK(told["disc"]["visible"] == true);
    CHECK(told["disc"]["position"] == nlohmann::json{10, 20, 30});
    CHECK(told["disc"]["radius"].get<double>() ==
          doctest::Approx(std::cbrt(3 * kGap_mm3 / (4 * std::numbers::pi))).epsilon(1e-3));
  }
  CHECK(report["keys"]["picture"].get<std::string>().starts_with("sonoloft-"));
  CHECK(fs::file_size(kPageFolder / "picture.png") > 10'000);
  CHECK(report["names"].size() >= 20);
  for (const auto& control : report["names"]) CHECK(!control.get<std::string>().ends_with(' '));
}

TEST_CASE("view: in a looped replay frozen and silent viewers cost the others nothing, and no memory grows") {
  if (!browser_is_there()) return;
  const auto server = open_server();
  if (!server) return;
  const char* wanted = std::getenv("SONOLOFT_VIEW_SECONDS");
  const int seconds = wanted == nullptr ? 8 : std::atoi(wanted);
  const TemporaryFolder folder;
  record_ball(folder.path("ball.mcap"), 48, 40);
  SceneClient silent(port_of(*server));
  silent.say("next");  // and reads no answer
  auto browser = drive(server->url(), "loop", seconds);
  std::vector<double> resident;
  std::size_t meshes = 0;
  while (!done(browser)) {
    meshes += show_replay(folder.path("ball.mcap"), *server);
    resident.push_back(resident_mib());
  }
  MESSAGE(resident.size() << " replays, " << meshes << " meshes shown; server, MiB: " << resident[resident.size() / 4]
                          << " -> " << resident.back());
  REQUIRE(browser.get() == 0);
  const nlohmann::json report = report_of("loop");
  const view::ViewFigures figures = server->figures();
  MESSAGE("page's heap, MiB: " << report["heap_mib"].dump() << "; " << figures.messages_sent << " messages, "
                               << figures.bytes_sent << " bytes");
  CHECK(report["errors"].empty());
  CHECK(report["page"]["bricksReceived"] == report["page"]["bricksSent"]);
  CHECK(report["page"]["messages"] > report["before"]["messages"]);
  CHECK(report["frozen"]["bricksReceived"] == report["frozen"]["bricksSent"]);
  CHECK(resident.back() < resident[resident.size() / 4] + 64);
  CHECK(report["heap_mib"].back().get<double>() < report["heap_mib"][2].get<double>() + 64);
}
