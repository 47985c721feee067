#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "device_sim/simulator/memory_blobs.h"
#include "protocol/block.h"
#include "protocol/crc32c.h"
#include "tests/support/wire/firmware_bench.h"

using namespace sonoloft;
using namespace sonoloft::protocol;
using namespace sonoloft::test;

namespace {

using Bytes = std::vector<std::byte>;

Bytes some_blob(std::size_t len) {
  std::mt19937 random(5);
  Bytes bytes(len);
  std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(random() & 0x7F); });
  return bytes;
}

Status begin(FirmwareBench& bench, std::span<const std::byte> blob, BlobKind kind = BlobKind::firmware) {
  const BeginBlobRequest request{static_cast<std::uint32_t>(kind), static_cast<std::uint32_t>(blob.size()),
                                 crc32c(blob), 0};
  return bench.tell(Command::begin_blob, bytes_of(request));
}

void send(FirmwareBench& bench, std::span<const std::byte> blob, std::size_t offset, std::size_t len) {
  Bytes block(len + kMaxBlockOverhead);
  block.resize(encode_block({static_cast<std::uint32_t>(offset), blob.subspan(offset, len)}, block));
  bench.firmware.take_block(block);
}

BlobReply state_of(FirmwareBench& bench) {
  const auto reply = bench.ask<BlobReply>(Command::get_blob);
  REQUIRE(reply);
  return *reply;
}

bool is(const BlobReply& reply, BlobState state) {
  return reply.state == static_cast<std::uint16_t>(state);
}

}  // namespace

TEST_CASE("blobs: one that came in blocks is kept, once the store has it") {
  device_sim::MemoryBlobs store;
  FirmwareBench bench(4, &store);
  const Bytes blob = some_blob(10'000);
  CHECK(is(state_of(bench), BlobState::none));
  REQUIRE(begin(bench, blob) == Status::ok);
  CHECK(bench.tell(Command::keep_blob) == Status::wrong_state);
  for (std::size_t at = 0; at < blob.size(); at += 1000) {
    CHECK(state_of(bench).received == at);
    send(bench, blob, at, 1000);
  }
  CHECK(is(state_of(bench), BlobState::complete));
  CHECK(bench.tell(Command::keep_blob) == Status::pending);
  CHECK(bench.tell(Command::keep_blob) == Status::ok);
  CHECK(bench.tell(Command::keep_blob) == Status::ok);  // the first reply may have been lost
  CHECK(is(state_of(bench), BlobState::kept));
  CHECK(store.kept(BlobKind::firmware) == blob);
}

TEST_CASE("blobs: a block that is lost, late, repeated, too long or altered changes nothing") {
  device_sim::MemoryBlobs store;
  FirmwareBench bench(4, &store);
  const Bytes blob = some_blob(4000);
  REQUIRE(begin(bench, blob) == Status::ok);
  send(bench, blob, 0, 1000);
  send(bench, blob, 0, 1000);
  send(bench, blob, 2000, 1000);
  const Bytes longer = some_blob(9000);
  send(bench, longer, 1000, 4000);
  Bytes altered(1000 + kMaxBlockOverhead);
  altered.resize(encode_block({1000, std::span(blob).subspan(1000, 1000)}, altered));
  altered[500] ^= std::byte{1};
  bench.firmware.take_block(altered);
  bench.firmware.take_block({});
  CHECK(state_of(bench).received == 1000);
  send(bench, blob, 1000, 3000);
  CHECK(is(state_of(bench), BlobState::complete));
  CHECK(bench.tell(Command::keep_blob) == Status::pending);
  CHECK(bench.tell(Command::keep_blob) == Status::ok);
  CHECK(store.kept(BlobKind::firmware) == blob);
}

TEST_CASE("blobs: a sum that does not fit keeps nothing") {
  device_sim::MemoryBlobs store;
  FirmwareBench bench(4, &store);
  const Bytes blob = some_blob(64);
  REQUIRE(begin(bench, blob) == Status::ok);
  Bytes other = blob;
  other[1] ^= std::byte{1};
  send(bench, other, 0, 64);
  CHECK(is(state_of(bench), BlobState::spoiled));
  CHECK(bench.tell(Command::keep_blob) == Status::wrong_state);
  CHECK(store.kept(BlobKind::firmware).empty());
}

TEST_CASE("blobs: what the store does not take is given up, while it comes and at its end") {
  class Picky final : public device_sim::BlobStore {
   public:
    [[nodiscard]] std::uint32_t max_blob() const override { return 1000; }
    [[nodiscard]] bool begin(BlobKind, std::uint32_t) override { return true; }
    [[nodiscard]] bool write(std::span<const std::byte> bytes) override { return bytes.size() > 10; }
    [[nodiscard]] Kept keep() override { return Kept::no; }
  } store;
  FirmwareBench bench(4, &store);
  const Bytes blob = some_blob(64);
  REQUIRE(begin(bench, blob) == Status::ok);
  send(bench, blob, 0, 5);
  CHECK(is(state_of(bench), BlobState::none));
  REQUIRE(begin(bench, blob) == Status::ok);
  send(bench, blob, 0, 64);
  CHECK(bench.tell(Command::keep_blob) == Status::invalid_parameter);
  CHECK(is(state_of(bench), BlobState::none));
}

TEST_CASE("blobs: none while it streams, none of an unknown kind, none too long, and START gives up one half sent") {
  device_sim::MemoryBlobs store;
  FirmwareBench bench(4, &store);
  const Bytes blob = some_blob(100);
  CHECK(begin(bench, blob, static_cast<BlobKind>(9)) == Status::invalid_parameter);
  CHECK(begin(bench, {}) == Status::invalid_parameter);
  const BeginBlobRequest too_long{1, store.max_blob() + 1, 0, 0};
  CHECK(bench.tell(Command::begin_blob, bytes_of(too_long)) == Status::invalid_parameter);
  REQUIRE(begin(bench, blob) == Status::ok);
  REQUIRE(bench.start() == Status::ok);
  CHECK(is(state_of(bench), BlobState::none));
  CHECK(begin(bench, blob) == Status::wrong_state);
}

TEST_CASE("blobs: a device without a store says so") {
  FirmwareBench bench;
  CHECK(begin(bench, some_blob(10)) == Status::not_implemented);
  CHECK(bench.tell(Command::keep_blob) == Status::not_implemented);
  const auto info = bench.ask<InfoReply>(Command::get_info);
  CHECK((info->capabilities & kCapBlobs) == 0);
  CHECK(info->max_blob == 0);
}
