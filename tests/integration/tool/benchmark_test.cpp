#include <doctest/doctest.h>

#include "core/io/meshes/mesh_files.h"
#include "tests/integration/tool/tool_run.h"
#include "tests/support/mesh/solid_meshes.h"

using namespace sonoloft::test;

namespace {

/// The boxes of boxes_csl() as a mesh.
void write_boxes(const std::filesystem::path& path) {
  const auto box = [](float half, sonoloft::Label front, sonoloft::Label back) {
    return box_mesh(Eigen::Vector3d::Constant(-half), Eigen::Vector3d::Constant(half), front, back);
  };
  REQUIRE(sonoloft::write_ply(together(box(10, 0, 1), box(5, 1, 2)), path));
}

}  // namespace

TEST_CASE("tool evaluate: a benchmark measures every label of a set, and goes on where a set cannot be evaluated") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  write_boxes(folder.path("boxes.ply"));
  folder.write("lonely.csl", boxes_csl());
  folder.write("mangled.csl", boxes_csl());
  folder.write("mangled.off", "not a mesh");
  const ToolRun run = run_tool(folder, "evaluate --benchmark . --depth 6 --field step --report r.json");
  CHECK(run.status == 1);
  for (const char* word : {"lonely.ply", "mangled.off", "2 of the sets"})
    CHECK(run.err.find(word) != std::string::npos);
  for (const char* word : {"200000 points", "\nboxes", "\nmean"}) CHECK(run.out.find(word) != std::string::npos);
  const auto report = json_of(folder.path("r.json"));
  CHECK(report["failed"] == 2);
  CHECK(report["field"] == "step");
  REQUIRE(report["sets"].size() == 1);
  const auto figures = report["sets"]["boxes"];
  MESSAGE(figures.dump());
  CHECK(figures["planes"] == 14);
  CHECK(figures["iou_of_labels"]["1"] > 0.8);
  CHECK(figures["iou_of_labels"]["2"] > 0.8);
  CHECK(figures["hausdorff_percent"] < 12);
  CHECK(figures["truth_pieces"] == 3);  // the outer box's two surfaces and the inner box's one
  CHECK(report["mean"]["iou"] == figures["iou"]);
}

TEST_CASE("tool evaluate: a benchmark whose sets all can be evaluated is a success") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  write_boxes(folder.path("boxes.ply"));
  const ToolRun run = run_tool(folder, "evaluate --benchmark . --depth 5");
  CHECK_MESSAGE(run.status == 0, run.err);
  CHECK(run.err.empty());
}
