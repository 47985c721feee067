// Recordings, from the command line.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "tests/integration/tool/tool_run.h"

using namespace sonoloft::test;

namespace {

const std::string kSpace = " --device cpu --resolution-mm 8 --box -120 -120 -120 120 120 120 ";

/// "mesh <hash>  <vertices> ..."
std::string mesh_line(const ToolRun& run) {
  const auto begin = run.out.find("mesh ");
  return begin == std::string::npos ? "" : run.out.substr(begin, run.out.find('\n', begin) - begin);
}

void record(const TemporaryFolder& folder) {
  const ToolRun run = run_tool(folder, "record --simulated --phantom organs --slices 12 --rate 100 -o a.mcap");
  CAPTURE(run.err);
  REQUIRE(run.status == 0);
  REQUIRE(run.out.find("12 records") != std::string::npos);
}

}  // namespace

TEST_CASE("tool: a recording gives the same mesh every time, with any number of threads and at any speed") {
  const TemporaryFolder folder;
  record(folder);
  const ToolRun first = run_tool(folder, "replay a.mcap" + kSpace + "--speed max --threads 1 -o a.ply");
  CAPTURE(first.err);
  REQUIRE(first.status == 0);
  CHECK(mesh_line(first).size() > 30);
  const ToolRun second = run_tool(folder, "replay a.mcap" + kSpace + "--speed 2 --threads 2 -o b.ply");
  CHECK(mesh_line(first) == mesh_line(second));
  CHECK(bytes_of(folder.path("a.ply")) == bytes_of(folder.path("b.ply")));
  // And it is the mesh of the scan that could have been made instead.
  REQUIRE(run_tool(folder, "scan --simulated --phantom organs --slices 12 --rate 100 --lossless" + kSpace + "-o c.ply")
              .status == 0);
  CHECK(bytes_of(folder.path("a.ply")) == bytes_of(folder.path("c.ply")));
  MESSAGE(mesh_line(first));
}

TEST_CASE("tool: what was recorded before the recorder was killed is replayed, and the end is told") {
  const TemporaryFolder folder;
  const std::string record =
      std::string("'") + SONOLOFT_TOOL + "' record --simulated --phantom organs --slices 100000 --rate 60 -o ";
  for (const std::string name : {"a", "b", "c"}) {
    const std::string file = name + ".mcap";
    const std::string command = "cd '" + folder.path("").string() + "' && (touch " + name + ".txt; " + record + file +
                                " >" + name + ".txt & it=$!; until grep -q '[1-9][0-9]* records' " + name +
                                ".txt; do sleep 0.1; done; kill -KILL $it; wait $it; true)";
    REQUIRE(std::system(command.c_str()) == 0);
    const ToolRun run = run_tool(folder, "replay " + file + kSpace + "--speed max");
    CAPTURE(run.err);
    CHECK(run.status == 0);
    CHECK(run.err.find(file + ": ends at byte ") != std::string::npos);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK(run.err.find("dropped") == std::string::npos);
    MESSAGE(run.out.substr(0, run.out.find('\n')), "  ", mesh_line(run));
  }
}

TEST_CASE("tool: a recording that is damaged, of something else or there already is an error that says where") {
  const TemporaryFolder folder;
  record(folder);
  std::string bytes = bytes_of(folder.path("a.mcap"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  folder.write("flipped.mcap", bytes);
  folder.write("foreign.mcap", "not a recording");
  struct Bad {
    const char* arguments;
    int status;
    const char* word;
  };
  for (const Bad& bad : {Bad{"replay flipped.mcap", 1, "flipped.mcap: byte "},
                         {"replay foreign.mcap", 1, "foreign.mcap: byte 0: this is no MCAP file"},
                         {"replay none.mcap", 1, "none.mcap"},
                         {"replay a.mcap --speed 0", 2, "--speed"},
                         {"replay a.mcap --speed fast", 2, "--speed"},
                         {"replay", 2, "recording"},
                         {"record", 2, "--output"},
                         {"record -o a.csl", 2, ".mcap"},
                         {"record --simulated --phantom organs -o a.mcap", 1, "name another file"}}) {
    const ToolRun run = run_tool(folder, bad.arguments);
    CAPTURE(bad.arguments);
    CAPTURE(run.err);
    CHECK(run.status == bad.status);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK(run.err.find(bad.word) != std::string::npos);
  }
}
