#include <doctest/doctest.h>

#include "tests/integration/tool/tool_run.h"

using namespace sonoloft::test;

namespace {

/// 20 x 20 x 20 voxels of 1 mm, centres from 0.5 on: grey value `outer` for x < 10, `inner` for x >= 15, two voxels of
/// 84 between them.
std::string inr_volume(unsigned char outer, unsigned char inner) {
  std::string text =
      "#INRIMAGE-4#{\nXDIM=20\nYDIM=20\nZDIM=20\nVDIM=1\nVX=1\nVY=1\nVZ=1\nTX=0.5\nTY=0.5\nTZ=0.5\n"
      "TYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=decm\n";
  text.resize(252, '\n');
  text += "##}\n";
  for (int i = 0; i < 8000; ++i) {
    const int x = i % 20;
    text += static_cast<char>(x < 10 ? outer : x >= 15 ? inner : i == 12 || i == 13 ? 84 : 0);
  }
  return text;
}

}  // namespace

TEST_CASE("tool evaluate: two boxes have the overlap and the distance of two boxes") {
  const TemporaryFolder folder;
  folder.write("small.off", box_off(10, 20, 30));
  folder.write("large.off", box_off(10, 20, 40));
  const ToolRun run = run_tool(folder, "evaluate small.off --truth large.off --report r.json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  const auto report = json_of(folder.path("r.json"));
  CHECK(report["labels"]["1"]["iou"].get<double>() == doctest::Approx(0.75).epsilon(1e-3));
  CHECK(report["labels"]["1"]["dice"].get<double>() == doctest::Approx(6.0 / 7).epsilon(1e-3));
  const double diagonal = report["truth_diagonal_mm"];
  CHECK(diagonal == doctest::Approx(std::sqrt(100 + 400 + 1600)));
  CHECK(report["labels"]["1"]["distance"]["max"].get<double>() * diagonal == doctest::Approx(10));
  CHECK(report["surface_distance"]["max"].get<double>() * diagonal == doctest::Approx(10));
  CHECK(report["surface_distance"]["mean"] > 0);
}

TEST_CASE("tool evaluate: voxels are taken by their labels, or grey values numbered by falling volume") {
  const TemporaryFolder folder;
  folder.write("box.off", box_off(10, 20, 20));
  folder.write("labels.inr", inr_volume(1, 2));
  folder.write("grey.inr", inr_volume(255, 127));
  for (const char* truth : {"labels.inr", "grey.inr"}) {
    const ToolRun run = run_tool(folder, std::string("evaluate box.off --report r.json --truth ") + truth);
    REQUIRE_MESSAGE(run.status == 0, run.err);
    const auto labels = json_of(folder.path("r.json"))["labels"];
    CHECK(labels["1"]["iou"].get<double>() == doctest::Approx(1));
    CHECK(labels["2"]["iou"].get<double>() == 0);
    CHECK(labels.contains("84") == (std::string(truth) == "labels.inr"));
    CHECK((run.out.find("grey value 255 is label 1") != std::string::npos) == (std::string(truth) == "grey.inr"));
  }
}
