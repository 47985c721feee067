#include <doctest/doctest.h>

#include <cmath>

#include "tests/integration/tool/tool_run.h"
#include "tests/support/recorded_sets.h"

using namespace sonoloft::test;

TEST_CASE("tool stats: of a simulated probe every record is accounted for, and its clock is mapped") {
  const TemporaryFolder folder;
  const ToolRun run = run_tool(folder, "stats --simulated --phantom organs --slices 30 --rate 0 --seconds 60");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  for (const char* words : {"books                closed", "transport_lost     0", "device's clock       drift",
                            "arrival to callback", "nothing more in this session"}) {
    CHECK_MESSAGE(run.out.find(words) != std::string::npos, words, " is not in:\n", run.out);
  }
}

TEST_CASE("tool send: a file goes to a probe, which keeps it; what is no file, or nothing at all, is named") {
  const TemporaryFolder folder;
  folder.write("image.bin", std::string(100'000, 'x'));
  folder.write("empty.bin", "");
  for (const char* kind : {"firmware", "calibration"}) {
    const ToolRun run = run_tool(folder, std::string("send ") + kind + " image.bin --simulated --phantom organs");
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(run.out.find("100000 bytes sent, and kept") != std::string::npos);
  }
  CHECK(run_tool(folder, "send firmware empty.bin --simulated --phantom organs").err.find("a blob of 0 bytes") !=
        std::string::npos);
  CHECK(run_tool(folder, "send firmware missing.bin --simulated --phantom organs").err.find("missing.bin") !=
        std::string::npos);
  CHECK(run_tool(folder, "send poem image.bin --simulated --phantom organs").status == 2);
}

TEST_CASE("tool calibrate-time: the water tank's answer is within 5 ms of the known one") {
  const auto video = recorded_set("tracked/WaterTankBottomTranslationVideoBuffer.igs.mha");
  const auto tracker = recorded_set("tracked/WaterTankBottomTranslationTrackerBuffer.igs.mha");
  if (!video || !tracker) return;
  const TemporaryFolder folder;
  const ToolRun run = run_tool(folder, "calibrate-time '" + absolute(*video).string() + "' --poses '" +
                                           absolute(*tracker).string() + "' --report r.json");
  REQUIRE_MESSAGE(run.status == 0, run.err);
  CHECK(std::abs(json_of(folder.path("r.json"))["offset_ms"].get<double>() - -64.8) < 5);
  const ToolRun wrong = run_tool(folder, "calibrate-time '" + absolute(*video).string() + "'");
  CHECK(wrong.status == 1);
  CHECK(wrong.err.find("--poses") != std::string::npos);  // the images' file has none
}
