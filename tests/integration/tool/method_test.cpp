#include <doctest/doctest.h>

#include "core/io/meshes/mesh_files.h"
#include "tests/integration/tool/tool_run.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

/// The nine parallel slices of the boxes.
std::string stack_csl() {
  std::string text = boxes_csl();
  text.replace(text.find("14 2"), 4, "9 2");
  return text.substr(0, text.find("\n10 ") + 1);
}

}  // namespace

TEST_CASE("tool reconstruct: every method makes a mesh, a report and a picture of a stack") {
  const TemporaryFolder folder;
  folder.write("stack.csl", stack_csl());
  for (const std::string method : {"equal-importance", "medial-axis --method-option fairing=off",
                                   "metamorphosis --method-option ends=flat", "straight-skeleton"}) {
    const ToolRun run =
        run_tool(folder, "reconstruct stack.csl -o m.ply --depth 6 --report r.json --picture m.png --method " + method);
    REQUIRE_MESSAGE(run.status == 0, run.err);
    const auto report = json_of(folder.path("r.json"));
    CHECK(report["method"] == method.substr(0, method.find(' ')));
    CHECK(report["input"]["planes"] == 9);
    CHECK(report["notes"].is_array());
    CHECK(report["labels"].size() == 2);
    const auto mesh = read_mesh(folder.path("m.ply"));
    REQUIRE(mesh);
    CHECK(mesh->triangles.size() == report["triangles"]);
    CHECK(bytes_of(folder.path("m.png")).starts_with("\x89PNG"));
  }
}

TEST_CASE("tool reconstruct: a method says what it does not take, and no option of the live one goes with it") {
  const TemporaryFolder folder;
  folder.write("boxes.csl", boxes_csl());
  const std::string command = "reconstruct boxes.csl -o m.ply --depth 5 --method ";
  const ToolRun crossed = run_tool(folder, command + "metamorphosis");
  CHECK(crossed.status == 1);
  CHECK(crossed.err.find("slice 10 is oblique to the first: reconstruct without --method") != std::string::npos);
  const ToolRun value = run_tool(folder, command + "metamorphosis --method-option ends=open");
  CHECK(value.status == 2);
  CHECK(value.err.find("flat, round") != std::string::npos);
  for (const char* wrong : {"nothing", "metamorphosis --online", "metamorphosis --mesher live"})
    CHECK(run_tool(folder, command + wrong).status == 2);
  CHECK(run_tool(folder, "reconstruct boxes.csl -o m.ply --method-option ends=flat").status == 2);
}
