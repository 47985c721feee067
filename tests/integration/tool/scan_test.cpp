// The verbs that reach probes, without a probe.
#include <doctest/doctest.h>

#include "tests/integration/tool/tool_run.h"

using namespace sonoloft::test;

TEST_CASE("tool: a scan of a simulated probe writes the same mesh every time") {
  const TemporaryFolder folder;
  const std::string arguments =
      "scan --simulated --phantom organs --slices 12 --rate 0 --lossless --device cpu --resolution-mm 8 "
      "--box -120 -120 -120 120 120 120 -o ";
  const ToolRun run = run_tool(folder, arguments + "a.ply");
  CAPTURE(run.err);
  REQUIRE(run.status == 0);
  CHECK(run.out.find("12 slices") != std::string::npos);
  REQUIRE(run_tool(folder, arguments + "b.ply").status == 0);
  CHECK(bytes_of(folder.path("a.ply")) == bytes_of(folder.path("b.ply")));
  CHECK(bytes_of(folder.path("a.ply")).size() > 1000);
}

TEST_CASE("tool: a probe that is simulated for others says how to plug it in, and ends when it is told to") {
  const TemporaryFolder folder;
  const std::string command = "cd '" + folder.path("").string() +
                              "' && ('" SONOLOFT_TOOL
                              "' probe --usbip --port 0 --phantom organs >out.txt & probe=$!; "
                              "until grep -q 'attach -r 127.0.0.1 -b 1-1' out.txt; do sleep 0.1; done; "
                              "kill -TERM $probe; wait $probe)";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(bytes_of(folder.path("out.txt")).find("usbip --tcp-port ") != std::string::npos);
}
