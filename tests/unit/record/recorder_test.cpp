#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include "host/record/replay/recording_reader.h"
#include "tests/unit/record/recordings.h"

using namespace sonoloft;
using namespace sonoloft::record;
using namespace sonoloft::test;

namespace {

std::vector<std::vector<std::byte>> transfers_of(const std::filesystem::path& path) {
  auto reader = RecordingReader::open(path);
  REQUIRE(reader);
  std::vector<std::vector<std::byte>> transfers;
  while (true) {
    const auto next = reader->next();
    if (!next) FAIL(next.error().message);
    if (!*next) return transfers;
    if (const auto* transfer = std::get_if<RecordedTransfer>(&(*next)->what)) {
      CHECK(reinterpret_cast<std::uintptr_t>(transfer->bytes.data()) % 64 == 0);
      transfers.emplace_back(transfer->bytes.begin(), transfer->bytes.end());
    }
  }
}

void hand_over(Recorder& recorder, const std::vector<std::byte>& transfer) {
  AlignedBytes aligned(transfer.size());
  std::copy(transfer.begin(), transfer.end(), aligned.bytes().begin());
  recorder.transfer(aligned.bytes());
}

/// As long as it lives, a file of this process ends here: what a full disk answers.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

}  // namespace

TEST_CASE("record: whatever came off the wire comes out as it was, sound or not") {
  std::vector<std::vector<std::byte>> sent;
  for (std::size_t size = 0; size < 200; ++size) sent.emplace_back(size, static_cast<std::byte>(size));
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    auto owned = make_wire_slice(seed, 1 + seed % 9);
    sent.push_back(make_record(owned.view(), seed));
    sent.push_back(sent.back());
    sent.back()[(seed * 7919) % sent.back().size()] ^= std::byte{4};
    sent.push_back(sent[sent.size() - 2]);
    sent.back().resize(sent.back().size() - seed);
  }
  const TemporaryFolder folder;
  const auto recorder = Recorder::create(folder.path("a.mcap"));
  REQUIRE(recorder);
  for (const auto& transfer : sent) hand_over(**recorder, transfer);
  REQUIRE((*recorder)->close());
  CHECK((*recorder)->figures().transfers == sent.size());
  const auto received = transfers_of(folder.path("a.mcap"));
  REQUIRE(received.size() == sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) CHECK_MESSAGE(received[i] == sent[i], i);
  MESSAGE(sent.size(), " transfers");
}

TEST_CASE("record: a message of a slice begins with what its schema describes, and is no longer than the record") {
  const TemporaryFolder folder;
  const auto recorder = Recorder::create(folder.path("a.mcap"));
  REQUIRE(recorder);
  auto owned = make_wire_slice(1);
  const auto bytes = make_record(owned.view());
  hand_over(**recorder, bytes);
  REQUIRE((*recorder)->close());
  auto reader = mcap::McapReader::open(folder.path("a.mcap"));
  REQUIRE(reader);
  const auto message = (*reader)->next();
  REQUIRE(message);
  REQUIRE(*message);
  CHECK((*message)->topic == "/slices");
  AlignedBytes aligned(bytes.size());
  REQUIRE((*message)->data.size() == bytes.size());
  std::copy((*message)->data.begin(), (*message)->data.end(), aligned.bytes().begin());
  protocol::Slice slice;
  REQUIRE(protocol::decode_slice(aligned.bytes(), slice));
  slice.time_ns = owned.slice.time_ns;  // the header's
  CHECK(same(slice, owned.view()));
}

TEST_CASE("record: the file says in words which probe, firmware, calibration and program made it") {
  const TemporaryFolder folder;
  record_run(folder.path("a.mcap"), 1);
  const std::string file = content(folder.path("a.mcap"));
  for (const char* words :
       {"firmware", "LOOP-1", "image_to_probe", "0 -0.25 0 5; 0.20000000000000001 0 0 -40; 0 0 1 12", "host",
        "SonoLoft ", "sonoloft.protocol.wire.Slice"})
    CHECK_MESSAGE(file.find(words) != std::string::npos, words);
}

TEST_CASE("record: a full disk is told, what finds no room is counted, and what came before can be read") {
  constexpr std::size_t kRoom = 3u << 20, kTransfer = 1u << 16;
  const TemporaryFolder folder;
  const auto recorder = Recorder::create(folder.path("a.mcap"));
  REQUIRE(recorder);
  const std::vector<std::byte> transfer(kTransfer, std::byte{1});
  std::uint64_t sent = 0;
  {
    const FullDisk disk(kRoom);
    for (; !(*recorder)->figures().failure && sent < 100'000; ++sent) {
      hand_over(**recorder, transfer);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    for (int more = 0; more < 10; ++more, ++sent) hand_over(**recorder, transfer);
    const auto closed = (*recorder)->close();
    REQUIRE(!closed);
    CHECK(closed.error().code == ErrorCode::io_failed);
    CHECK(closed.error().message.find("a.mcap: File too large") != std::string::npos);
  }
  const RecorderFigures figures = (*recorder)->figures();
  CHECK(figures.transfers + figures.not_recorded == sent);
  CHECK(figures.not_recorded >= 10);
  const std::size_t read = transfers_of(folder.path("a.mcap")).size();
  CHECK(read == figures.transfers);
  CHECK(read >= 16);
  CHECK(read < kRoom / kTransfer);
  MESSAGE("sent ", sent, ", read ", read, ", not recorded ", figures.not_recorded);
}
