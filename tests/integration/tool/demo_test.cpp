#include <doctest/doctest.h>

#include "core/io/meshes/mesh_files.h"
#include "core/io/slices/slice_files.h"
#include "tests/integration/tool/tool_run.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

void check_books(const nlohmann::json& report, std::uint64_t slices) {
  const auto& c = report["slices"];
  const auto& l = report["ledger"];
  CAPTURE(c.dump());
  CAPTURE(l.dump());
  const auto sum = [](const nlohmann::json& j, std::initializer_list<const char*> keys) {
    std::uint64_t total = 0;
    for (const char* key : keys) total += j[key].get<std::uint64_t>();
    return total;
  };
  CHECK(c["delivered"] == sum(c, {"inserted", "explained", "merged", "refused", "dropped"}));
  CHECK(l["sent"] == slices);
  CHECK(l["closed"] == true);
  CHECK(l["sent"] == sum(l, {"delivered", "host_dropped", "crc_bad", "malformed", "transport_lost", "device_dropped"}));
  CHECK(l["delivered"] == c["delivered"]);
}

}  // namespace

TEST_CASE("tool demo: organs of 40 freehand slices at full speed have a Dice of 0.9 for each large label") {
  const TemporaryFolder folder;
  const ToolRun run = run_tool(
      folder, "demo --phantom organs --slices 40 --rate 0 --depth 6 --device cpu --out result --report r.json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto report = json_of(folder.path("r.json"));
  check_books(report, 40);
  CHECK(report["slices"]["inserted"] > 10);
  CHECK(report["slices"]["refused"] == 0);
  CHECK(report["coverage"]["seen"] > 0.5);
  for (const char* label : {"1", "2", "3"}) CHECK(report["dice"][label] >= 0.9);
  for (const char* label : {"4", "5"}) CHECK(report["dice"][label] >= 0.7);  // a few cells across
  MESSAGE("Dice ", report["dice"].dump());
  for (const char* group : {"latency_ms", "insert_ms"}) {
    CHECK(report[group]["p50"] > 0);
    CHECK(report[group]["p95"] >= report[group]["p50"]);
    CHECK(report[group]["max"] >= report[group]["p95"]);
  }
  const auto mesh = read_mesh(folder.path("result/mesh.ply"));
  REQUIRE(mesh);
  CHECK(mesh->triangles.size() == report["triangles"]);
  CHECK(bytes_of(folder.path("result/mesh.png")).starts_with("\x89PNG"));
}

TEST_CASE("tool demo: slices that come as masks of 512 pixels give the body that contours give") {
  const TemporaryFolder folder;
  nlohmann::json dice[2];
  for (const int masks : {0, 1}) {
    const ToolRun run =
        run_tool(folder, std::string("demo --phantom organs --slices 20 --rate 0 --depth 6 --device cpu "
                                     "--out result --report r.json") +
                             (masks != 0 ? " --masks" : ""));
    REQUIRE_MESSAGE(run.status == 0, run.err);
    const auto report = json_of(folder.path("r.json"));
    check_books(report, 20);
    CHECK(report["slices"]["refused"] == 0);
    dice[masks] = report["dice"];
  }
  MESSAGE("Dice of contours ", dice[0].dump(), ", of masks ", dice[1].dump());
  for (const char* label : {"1", "2", "3"}) {
    CHECK(dice[1][label].get<double>() == doctest::Approx(dice[0][label].get<double>()).epsilon(0.01));
  }
}

TEST_CASE("tool demo: the same seed gives the same mesh, another one another") {
  const TemporaryFolder folder;
  folder.write("box.off", box_off(30, 40, 60));
  const auto mesh = [&](const std::string& options) {
    const ToolRun run =
        run_tool(folder, "demo --phantom box.off --slices 30 --rate 0 --depth 5 --device cpu " + options);
    REQUIRE_MESSAGE(run.status == 0, run.err);
    return bytes_of(folder.path("out/mesh.ply"));
  };
  const std::string first = mesh("--seed 1 --report r.json");
  const auto report = json_of(folder.path("r.json"));
  check_books(report, 30);
  CHECK(report["dice"]["1"] >= 0.9);
  CHECK(first == mesh("--seed 1 --threads 1"));
  CHECK(first != mesh("--seed 2"));
}

TEST_CASE("tool demo: recorded slices are sent as they were taken, and there is no truth") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  const ToolRun run = run_tool(folder, "demo --phantom boxes.csl --rate 200 --depth 6 --device cpu --report r.json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto report = json_of(folder.path("r.json"));
  check_books(report, 14);
  CHECK(report["dice"] == nlohmann::json::object());
  CHECK(report["labels"]["1"]["volume_ml"].get<double>() == doctest::Approx(7).epsilon(0.1));
  CHECK(report["labels"]["2"]["volume_ml"].get<double>() == doctest::Approx(1).epsilon(0.3));
}

TEST_CASE("tool demo: the torso's slices, shadows and views among them, are saved and read again") {
  const TemporaryFolder folder;
  const ToolRun run = run_tool(
      folder, "demo --phantom torso --slices 40 --rate 0 --depth 5 --device cpu --save-slices s.csl --report r.json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto report = json_of(folder.path("r.json"));
  check_books(report, 40);
  CHECK(report["slices"]["refused"] == 0);
  const auto saved = read_csl(folder.path("s.csl"));
  REQUIRE_MESSAGE(saved, saved.error().message);
  CHECK(saved->slices.size() == 40);
  for (const TrackedSlice& slice : saved->slices) CHECK(slice.field_of_view.size() >= 3);
  const ToolRun again = run_tool(folder, "demo --phantom s.csl --rate 0 --depth 5 --device cpu --save-slices t.csl");
  REQUIRE_MESSAGE(again.status == 0, again.err);
  const auto replayed = read_csl(folder.path("t.csl"));
  REQUIRE_MESSAGE(replayed, replayed.error().message);
  REQUIRE(replayed->slices.size() == 40);
  for (std::size_t i = 0; i < 40; ++i) {
    CHECK(replayed->slices[i].field_of_view.size() == saved->slices[i].field_of_view.size());
    CHECK(replayed->slices[i].points.size() == saved->slices[i].points.size());
  }
}

TEST_CASE("tool demo: Ctrl-C ends it with a mesh and a report") {
  const TemporaryFolder folder;
  ToolRun run{1, {}, {}};
  // On a machine that has much else to do it gets more time for its first slices.
  for (int seconds = 1; seconds <= 32 && run.status != 0; seconds *= 2)
    run = run_tool(folder, "demo --phantom organs --seconds 600 --rate 10 --depth 5 --device cpu --report r.json",
                   "timeout --preserve-status -s INT " + std::to_string(seconds));
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto report = json_of(folder.path("r.json"));
  const std::uint64_t sent = report["ledger"]["sent"];
  CHECK(sent > 0);
  CHECK(sent < 6000);
  check_books(report, sent);
  CHECK(read_mesh(folder.path("out/mesh.ply")));
}
