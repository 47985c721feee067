// Recordings that are not as they were written.
#include "host/record/mcap/mcap_writer.h"
#include "tests/unit/record/recordings.h"

using namespace sonoloft;
using namespace sonoloft::record;
using namespace sonoloft::test;

namespace {

Result<RecordingFacts> facts_of(const std::filesystem::path& path) {
  const auto replay = ReplayTransport::open(path, 0);
  if (!replay) return tl::unexpected<Error>(replay.error());
  return (*replay)->facts();
}

bool says_where(const std::string& message) {
  return message.find("byte ") != std::string::npos;
}

}  // namespace

TEST_CASE("recording: cut off at any byte it replays all that was written before, and says where it ends") {
  const TemporaryFolder folder;
  record_run(folder.path("a.mcap"), 3);
  const auto path = folder.path("a.mcap");
  const std::size_t size = std::filesystem::file_size(path);
  std::uint64_t left = 3;
  std::size_t replayable = 0;
  for (std::size_t cut = size; cut-- > 0;) {
    std::filesystem::resize_file(path, cut);
    const auto facts = facts_of(path);
    CAPTURE(cut);
    REQUIRE(says_where(facts ? facts->cut.value_or("") : facts.error().message));
    const std::uint64_t transfers = facts ? facts->transfers : 0;
    REQUIRE(transfers <= left);
    left = transfers;
    replayable += transfers == 3 ? 1 : 0;
  }
  CHECK(replayable > 100);
  MESSAGE(size, " cuts, ", replayable, " with all three slices");
}

TEST_CASE("recording: no altered bit goes unnoticed, and what is said names the byte") {
  const TemporaryFolder folder;
  record_run(folder.path("a.mcap"), 2);
  const auto path = folder.path("a.mcap");
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const std::string whole = content(path);
  const auto put = [&](std::size_t at, char byte) {
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte).flush();
  };
  std::size_t errors = 0, cuts = 0;
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 3) {
    put(bit / 8, static_cast<char>(whole[bit / 8] ^ (1 << (bit % 8))));
    const auto facts = facts_of(path);
    put(bit / 8, whole[bit / 8]);
    CAPTURE(bit);
    REQUIRE(says_where(facts ? facts->cut.value_or("") : facts.error().message));
    (facts ? cuts : errors) += 1;
  }
  MESSAGE(errors, " errors, ", cuts, " lengths that go beyond the file");
  CHECK(errors > 100 * cuts);
}

TEST_CASE("recording: files of others are refused with a word of what they are") {
  const TemporaryFolder folder;
  const auto message = [&](std::string_view bytes) {
    const auto facts = facts_of(folder.write("a.mcap", bytes));
    REQUIRE(!facts);
    return facts.error().message;
  };
  CHECK(message("").find("byte 0: this is no MCAP file") != std::string::npos);
  CHECK(message("ply\nformat ascii 1.0\n").find("byte 0: this is no MCAP file") != std::string::npos);
  auto ros = mcap::McapWriter::create(folder.path("ros.mcap"), {"ros2", "another", {}, {}});
  REQUIRE(ros);
  REQUIRE((*ros)->finish());
  const auto other = facts_of(folder.path("ros.mcap"));
  REQUIRE(!other);
  CHECK(other.error().message.find("profile \"ros2\"") != std::string::npos);
  const auto missing = facts_of(folder.path("none.mcap"));
  REQUIRE(!missing);
  CHECK(missing.error().code == ErrorCode::file_not_found);
  const auto directory = facts_of(folder.path(""));
  REQUIRE(!directory);
  CHECK(directory.error().code == ErrorCode::io_failed);
}
