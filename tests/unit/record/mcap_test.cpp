#include <zlib.h>

#include "host/record/mcap/mcap_reader.h"
#include "host/record/mcap/mcap_writer.h"
#include "tests/unit/record/recordings.h"

using namespace sonoloft;
using namespace sonoloft::record::mcap;
using namespace sonoloft::test;

namespace {

const Opening kOpening{
    "test", "nobody", {{1, "Table", "none", "schema"}}, {{7, 1, "/a", "none"}, {9, 1, "/b", "none"}}};

void write(const std::filesystem::path& path) {
  auto writer = McapWriter::create(path, kOpening);
  REQUIRE(writer);
  McapChunk first, second;
  first.add(7, 0, 1000, {bytes_of("one"), bytes_of(" in two parts")});
  first.add(9, 0, 1001, {bytes_of("two")});
  second.add(9, 1, 1002, {});
  REQUIRE((*writer)->write(first));
  REQUIRE((*writer)->write_metadata("what", {{"key", "value"}}));
  REQUIRE((*writer)->write(second));
  REQUIRE((*writer)->finish());
  REQUIRE((*writer)->sync());
  CHECK((*writer)->size() == content(path).size());
}

}  // namespace

TEST_CASE("mcap: messages come out of a file in the order and with the times that they went in with") {
  const TemporaryFolder folder;
  write(folder.path("a.mcap"));
  auto reader = McapReader::open(folder.path("a.mcap"));
  REQUIRE(reader);
  CHECK((*reader)->profile() == "test");
  CHECK((*reader)->library() == "nobody");
  struct Expected {
    const char *topic, *text;
    std::uint64_t time_ns;
  };
  for (const Expected& expected : {Expected{"/a", "one in two parts", 1000}, {"/b", "two", 1001}, {"/b", "", 1002}}) {
    const auto message = (*reader)->next();
    REQUIRE(message);
    REQUIRE(*message);
    CHECK((*message)->topic == expected.topic);
    CHECK(text_of((*message)->data) == expected.text);
    CHECK((*message)->time_ns == expected.time_ns);
  }
  for (int again = 0; again < 2; ++again) {
    const auto end = (*reader)->next();
    REQUIRE(end);
    CHECK(!*end);
  }
  CHECK(!(*reader)->cut());
}

TEST_CASE("mcap: a file is as the specification has it, byte for byte") {
  const TemporaryFolder folder;
  write(folder.path("a.mcap"));
  const std::string file = content(folder.path("a.mcap"));
  CHECK(file.starts_with(std::string("\x89MCAP0\r\n\x01\x12\0\0\0\0\0\0\0\x04\0\0\0test\x06\0\0\0nobody", 35)));
  CHECK(file.ends_with(kMagic));
  // From the end: magic 8, footer 9 + 20. Its summary begins behind the data's end, 9 + 4, whose sum is of all before.
  const std::size_t footer = file.size() - kMagic.size() - kFooterLen - kRecordHeadLen;
  CHECK(file[footer] == 2);
  const auto number = [&](std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, file.data() + at, sizeof value);
    return value;
  };
  const std::size_t summary = number(footer + 9);
  const std::string_view all(file);
  CHECK(number(footer + 25) == crc32(all.substr(summary, footer + 25 - summary)));
  CHECK(file[summary - 13] == 0x0F);
  CHECK(number(summary - 4) == crc32(all.substr(0, summary - 13)));
}

TEST_CASE("mcap: a file that is there is never written over") {
  const TemporaryFolder folder;
  const auto path = folder.write("a.mcap", "dear to somebody");
  const auto writer = McapWriter::create(path, kOpening);
  REQUIRE(!writer);
  CHECK(writer.error().code == ErrorCode::io_failed);
  CHECK(content(path) == "dear to somebody");
  const auto nowhere = McapWriter::create(folder.path("no/such/a.mcap"), kOpening);
  REQUIRE(!nowhere);
  CHECK(nowhere.error().message.find("No such file") != std::string::npos);
}
