// The picture as the tool serves it.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <string>

#include "tests/integration/view/browser.h"
#include "tests/integration/view/scene_client.h"
#include "tests/integration/view/view_support.h"
#include "tests/support/temporary_folder.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

/// The tool, running; ended by Ctrl-C.
class RunningTool {
 public:
  explicit RunningTool(const std::string& arguments)
      : pipe_(popen(("echo $$; exec '" SONOLOFT_TOOL "' " + arguments + " 2>&1").c_str(), "r")) {
    pid_ = std::stoi(line());
  }
  ~RunningTool() {
    if (pipe_ != nullptr) static_cast<void>(interrupt());
  }
  RunningTool(const RunningTool&) = delete;
  RunningTool& operator=(const RunningTool&) = delete;

  /// The next line that begins with this; empty when there is none any more.
  std::string line(const std::string& beginning = "") {
    std::array<char, 512> text{};
    while (std::fgets(text.data(), static_cast<int>(text.size()), pipe_) != nullptr)
      if (std::string(text.data()).starts_with(beginning)) return text.data();
    return "";
  }
  std::uint16_t port() {
    const std::string url = line("view: http://127.0.0.1:");
    REQUIRE(!url.empty());
    return static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  }
  /// @return the exit status
  int interrupt() {
    kill(pid_, SIGINT);
    const int status = pclose(std::exchange(pipe_, nullptr));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  FILE* pipe_;
  pid_t pid_ = 0;
};

constexpr const char* kBox =
    "OFF\n8 12 0\n0 0 0\n30 0 0\n0 20 0\n30 20 0\n0 0 10\n30 0 10\n0 20 10\n30 20 10\n"
    "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 5\n3 3 7 5\n";

}  // namespace

TEST_CASE("view: `sonoloft view` shows a mesh of a file until Ctrl-C") {
  if (!open_server()) return;
  const TemporaryFolder folder;
  RunningTool tool("view '" + folder.write("box.off", kBox).string() + "' --view-port 0");
  SceneClient viewer(tool.port());
  SceneMessage got = viewer.catch_up();
  while (got.head["bricks"]["all"] == 0) got = viewer.catch_up();
  CHECK(got.head["bricks"]["faces"] == 12);
  CHECK(got.head["labels"][0]["volume_ml"] == doctest::Approx(6));
  CHECK(got.head["stop"] == false);
  CHECK(tool.line("view: Ctrl-C ends it") != "");
  CHECK(tool.interrupt() == 0);
}

TEST_CASE("view: `sonoloft demo --view` ends its scan by the page, writes its mesh and still shows it") {
  if (!open_server()) return;
  const TemporaryFolder folder;
  // Enough of the body that a mesh is left whatever detail the last one has.
  RunningTool tool("demo --phantom organs --depth 6 --rate 10 --slices 300 --view --view-port 0 --out '" +
                   folder.path("out").string() + "'");
  SceneClient viewer(tool.port());
  SceneMessage got = viewer.catch_up();
  while (got.head["slices"]["delivered"] < 60 || got.head["bricks"]["all"] == 0) got = viewer.catch_up();
  CHECK(got.head["stop"] == true);
  CHECK(got.head["ledger"]["made"] > 0);
  CHECK(got.head["slices"]["delivered"] > 0);
  viewer.say("stop");
  CHECK(tool.line("view: Ctrl-C ends it") != "");
  CHECK(std::filesystem::exists(folder.path("out/mesh.ply")));
  while (got.head["state"] != "the scan is over") got = viewer.catch_up();
  CHECK(got.head["stop"] == false);
  CHECK(tool.interrupt() == 0);
}

TEST_CASE("view: the scan is recorded from the page, and what was recorded replays") {
  if (!open_server() || !browser_is_there()) return;
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return folder.path(name).string(); };
  RunningTool tool("demo --phantom organs --depth 5 --rate 20 --slices 100000 --view --view-port 0 --out '" +
                   path("out") + "'");
  auto browser = drive("http://127.0.0.1:" + std::to_string(tool.port()), "record");
  REQUIRE(browser.get() == 0);
  const nlohmann::json report = report_of("record");
  MESSAGE(report.dump());
  CHECK(report["errors"].empty());
  CHECK(report["before"] == "false");
  CHECK(report["during"] == nlohmann::json{"true", "true"});
  CHECK(report["after"] == "false");
  CHECK(tool.line("recorded: " + path("out/recording-1.mcap")).ends_with(" 0 not recorded\n"));

  RunningTool replay("replay '" + path("out/recording-1.mcap") + "' --speed max --resolution-mm 8");
  const std::string facts = replay.line();
  CHECK(std::stoi(facts) >= 10);
  CHECK(facts.find("records, 1 run,") != std::string::npos);
  int slices = 0;
  for (std::string line = replay.line(); !line.empty(); line = replay.line())
    if (line.find(" slices ") != std::string::npos) slices = std::stoi(line);
  MESSAGE(slices << " slices of " << facts);
  CHECK(slices > 0);
}

TEST_CASE("view: recordings get the first free number, and a replay is not recorded again") {
  if (!open_server()) return;
  const TemporaryFolder folder;
  folder.write("recording-1.mcap", "somebody's");
  const std::string output = folder.path("mesh.ply").string();
  RunningTool tool(
      "scan --simulated --phantom organs --rate 20 --slices 100000 --resolution-mm 8 --view --view-port 0 " +
      ("-o '" + output + "'"));
  SceneClient viewer(tool.port());
  const auto wait_for = [&](bool running) {
    SceneMessage got = viewer.catch_up();
    while (!got.head.contains("recording") || got.head["recording"]["running"] != running ||
           got.head["recording"]["records"] == 0)
      got = viewer.catch_up();
    return got.head["recording"]["file"].get<std::string>();
  };
  while (viewer.catch_up().head["record"] != true) continue;
  for (const char* name : {"recording-2.mcap", "recording-3.mcap"}) {
    viewer.say("record");
    viewer.say("record");  // that of another page, which is late
    CHECK(wait_for(true) == name);
    viewer.say("record-end");
    CHECK(wait_for(false) == name);
  }
  viewer.say("record");
  CHECK(wait_for(true) == "recording-4.mcap");
  viewer.say("stop");
  for (const char* name : {"recording-2.mcap", "recording-3.mcap", "recording-4.mcap"})
    CHECK(tool.line("recorded: ").find(name) != std::string::npos);
  CHECK(std::filesystem::file_size(folder.path("recording-1.mcap")) == 10);

  RunningTool replay("replay '" + folder.path("recording-4.mcap").string() + "' --speed 0.001 --view --view-port 0");
  SceneClient again(replay.port());
  nlohmann::json head = again.catch_up().head;
  while (head["state"] != "scanning") head = again.catch_up().head;
  CHECK(head["stop"] == true);
  CHECK(head["record"] == false);
}

TEST_CASE("view: a port that is taken is an error where it was asked for, and avoided where it was not") {
  const auto first = open_server();
  if (!first) return;
  const auto second = view::ViewServer::open({"127.0.0.1", port_of(*first)}, {});
  REQUIRE(!second);
  CHECK(second.error().code == ErrorCode::io_failed);
  const auto third = view::ViewServer::open({}, {}), fourth = view::ViewServer::open({}, {});
  REQUIRE(third);
  REQUIRE(fourth);
  CHECK((*third)->url() != (*fourth)->url());
  CHECK(view::ViewServer::open({"no address", 0}, {}).error().code == ErrorCode::invalid_argument);
}
