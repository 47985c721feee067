// What the tool says to a command line or a file that makes no sense.
#include <doctest/doctest.h>

#include <algorithm>

#include "tests/integration/tool/tool_run.h"

using namespace sonoloft::test;

namespace {

struct Bad {
  const char* arguments;
  int status;
  const char* word;  ///< must be in the message
};

constexpr Bad kBad[] = {
    {"", 2, "subcommand"},
    {"bogus", 2, "bogus"},
    {"--bogus", 2, "--bogus"},
    {"info extra", 2, "extra"},
    {"demo --bogus", 2, "--bogus"},
    {"demo info", 2, "info"},
    {"demo --slices 0", 2, "--slices"},
    {"demo --slices many", 2, "--slices"},
    {"demo --rate -1", 2, "--rate"},
    {"demo --rate nan", 2, "--rate"},
    {"demo --rate 0 --seconds 2", 2, "--rate"},
    {"demo --slices 5 --seconds 2", 2, "--seconds"},
    {"demo --depth 4", 2, "--depth"},
    {"demo --depth 11", 2, "--depth"},
    {"demo --depth 7 --resolution-mm 1", 2, "--resolution-mm"},
    {"demo --resolution-mm 0", 2, "--resolution-mm"},
    {"demo --device gpu", 2, "gpu"},
    {"demo --threads 0", 2, "--threads"},
    {"demo --seed -1", 2, "--seed"},
    {"reconstruct", 2, "input"},
    {"reconstruct boxes.csl", 2, "--output"},
    {"reconstruct notes.txt -o m.ply", 2, ".csl"},
    {"reconstruct boxes.csl -o m.abc", 2, ".vtp"},
    {"reconstruct boxes.csl -o m.ply --picture m.jpg", 2, ".png"},
    {"evaluate", 2, "--benchmark"},
    {"evaluate m.ply", 2, "--truth"},
    {"evaluate m.ply --truth t.ply --benchmark sets", 2, "--benchmark"},
    {"evaluate m.ply --truth t.ply --depth 6", 2, "--benchmark"},
    {"evaluate m.ply --truth t.ply --field step", 2, "--benchmark"},
    {"evaluate --benchmark sets --depth 4", 2, "--depth"},
    {"probe", 2, "--usbip"},
    {"probe --usbip --port 99999", 2, "--port"},
    {"probe --usbip --usbredir", 2, "--usbredir"},
    {"probe --functionfs nowhere --port 1", 2, "--port"},
    {"scan", 2, "--output"},
    {"scan -o m.abc", 2, ".vtp"},
    {"scan -o m.ply --box 0 0 0 1 1", 2, "--box"},
    {"devices extra", 2, "extra"},

    {"demo --data nowhere", 1, "--data"},
    {"demo --phantom nobody", 1, "organs"},
    {"demo --phantom missing.off", 1, "missing.off"},
    {"demo --phantom notes.off", 1, "notes.off"},
    {"demo --phantom open.off", 1, "open.off"},
    {"demo --phantom empty.inr", 1, "empty.inr"},
    {"demo --phantom organs --resolution-mm 0.001", 1, "--resolution-mm"},
    {"reconstruct missing.csl -o m.ply", 1, "missing.csl"},
    {"reconstruct empty.csl -o m.ply", 1, "empty.csl"},
    {"reconstruct half.csl -o m.ply", 1, "half.csl"},
    {"reconstruct boxes.csl --device cpu -o notes.txt/m.ply", 1, "notes.txt"},
    {"reconstruct boxes.csl --device cpu -o m.ply --report notes.txt/r.json", 1, "notes.txt"},
    {"evaluate missing.ply --truth box.off", 1, "missing.ply"},
    {"evaluate box.off --truth missing.inr.gz", 1, "missing.inr.gz"},
    {"evaluate box.off --truth notes.txt", 1, "notes.txt"},
    {"evaluate --benchmark nowhere", 1, "nowhere"},
    {"evaluate --benchmark empty", 1, "true mesh"},
    {"probe --usbip --phantom nobody", 1, "organs"},
    {"probe --functionfs nowhere --phantom organs", 1, "mount a functionfs"},
    {"scan --simulated --phantom nobody -o m.ply", 1, "organs"},
    {"scan --simulated --phantom box.off -o m.ply --box 5 5 5 1 1 1", 1, "--box"},
};

}  // namespace

TEST_CASE("tool: every bad command line and every bad file gets one line and its exit status") {
  const TemporaryFolder folder;
  folder.write("notes.txt", "not a mesh");
  std::filesystem::create_directories(folder.path("empty"));
  folder.write("notes.off", "not a mesh");
  folder.write("empty.csl", "");
  folder.write("empty.inr", "");
  folder.write("boxes.csl", boxes_csl());
  folder.write("half.csl", boxes_csl().substr(0, boxes_csl().size() / 2));
  folder.write("box.off", box_off(10, 20, 30));
  folder.write("open.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n");
  for (const Bad& bad : kBad) {
    const ToolRun run = run_tool(folder, bad.arguments);
    CAPTURE(bad.arguments);
    CAPTURE(run.err);
    CHECK(run.status == bad.status);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK(run.err.starts_with("sonoloft: "));
    CHECK(run.err.find(bad.word) != std::string::npos);
  }
  MESSAGE(std::size(kBad), " bad command lines");
}

TEST_CASE("tool: --help of the tool and of every verb explains on stdout and is no failure") {
  const TemporaryFolder folder;
  for (const char* verb :
       {"", "demo", "reconstruct", "evaluate", "stats", "calibrate-time", "info", "scan", "devices", "probe"}) {
    const ToolRun run = run_tool(folder, std::string(verb) + " --help");
    CHECK(run.status == 0);
    CHECK(run.err.empty());
    CHECK(run.out.find("Usage") != std::string::npos);
  }
}

TEST_CASE("tool: info names the version, the devices, the build and the data it finds") {
  const TemporaryFolder folder;
  folder.write("liver.inr.gz", "");
  const ToolRun run = run_tool(folder, "info --data .");
  CHECK(run.status == 0);
  CHECK(run.out.find("SonoLoft ") == 0);
  for (const char* word : {"build:", "OpenCL:", "CPU:", "./liver.inr.gz", "there is no femur.off in ."})
    CHECK(run.out.find(word) != std::string::npos);
}

TEST_CASE("tool: data are looked for in --data, else in SONOLOFT_DATA, else in build/data") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path("build/data/meshes"));
  std::filesystem::create_directories(folder.path("mine"));
  folder.write("build/data/meshes/femur.off", "");
  folder.write("mine/femur.off", "");
  CHECK(run_tool(folder, "info", "unset SONOLOFT_DATA;").out.find("build/data/meshes/femur.off") != std::string::npos);
  CHECK(run_tool(folder, "info", "SONOLOFT_DATA=mine").out.find("mine/femur.off") != std::string::npos);
  CHECK(run_tool(folder, "info --data other", "SONOLOFT_DATA=mine").out.find("no femur.off in other") !=
        std::string::npos);
}
