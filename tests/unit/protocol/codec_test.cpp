#include <doctest/doctest.h>

#include <cstring>

#include "tests/support/wire/wire_slices.h"

using namespace sonoloft::protocol;
using namespace sonoloft::test;

namespace {

// A slice's record, accepted from memory of its own.
struct Journey {
  Journey(const Slice& slice, std::uint64_t seq) : record(make_record(slice, seq)), transfer(record.size()) {
    std::memcpy(transfer.bytes().data(), record.data(), record.size());
    Acceptor acceptor(test_agreement());
    REQUIRE(acceptor.accept(transfer.bytes(), accepted) == Reject::none);
  }
  std::vector<std::byte> record;
  AlignedBytes transfer;
  AcceptedSlice accepted;
};

}  // namespace

TEST_CASE("codec: what was encoded comes back unchanged") {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    auto owned = make_wire_slice(seed, seed % 21, 3 + seed % 50);
    if (seed % 3 == 0) owned.field_of_view.clear();
    const Journey journey(owned.view(), seed);
    REQUIRE(same(journey.accepted.slice, owned.view()));
    REQUIRE(journey.accepted.header.seq == seed);
    REQUIRE(journey.accepted.header.device_dropped_total == 3);
    REQUIRE(journey.accepted.header.ring_used == 2);
    REQUIRE(journey.accepted.header.ring_capacity == 16);
  }
}

TEST_CASE("codec: a mask comes back unchanged, and its record says so to readers that know none") {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    auto owned = make_masked_slice(seed, static_cast<std::uint16_t>(1 + seed % 90));
    const Journey journey(owned.view(), seed);
    REQUIRE(same(journey.accepted.slice, owned.view()));
    REQUIRE(journey.accepted.header.incompat == kIncompatMask);
    REQUIRE(journey.record.size() <= max_record_len(owned.slice));
  }
}

TEST_CASE("codec: no record's length is a multiple of 64 and none is longer than promised") {
  std::size_t longest_slack = 0;
  for (std::uint32_t points = 3; points < 120; ++points) {
    auto owned = make_wire_slice(points, 1 + points % 4, points);
    const auto& slice = owned.view();
    const auto record = make_record(slice);
    const auto bound = max_record_len(slice);
    REQUIRE(record.size() % 64 != 0);
    REQUIRE(record.size() <= bound);
    longest_slack = std::max(longest_slack, static_cast<std::size_t>(bound) - record.size());
  }
  MESSAGE("the bound is at most " << longest_slack << " bytes over");
}

TEST_CASE("codec: a buffer that might be too small is refused before anything is built") {
  auto owned = make_wire_slice(1);
  const auto& slice = owned.view();
  const auto need = static_cast<std::size_t>(max_record_len(slice));
  AlignedBytes buffer(need);
  for (std::size_t size = 0; size < need; size += 7) {
    CHECK(encode_slice(slice, {0, 1, 0}, buffer.first(size)) == 0);
  }
  CHECK(encode_slice(slice, {0, 1, 0}, buffer.first(need)) > 0);
}

TEST_CASE("codec: the usual slice of 20 contours x 200 points takes 32 KB") {
  auto owned = make_wire_slice(3, 20, 200);
  const auto record = make_record(owned.view());
  MESSAGE(record.size() << " bytes");
  CHECK(record.size() == 32480);
}

TEST_CASE("codec: any garbage in a payload is either a slice or refused") {
  auto owned = make_wire_slice(5, 3, 12);
  const auto record = make_record(owned.view());
  RecordHeader header;
  std::memcpy(&header, record.data(), sizeof header);
  AlignedBytes payload(header.payload_len);
  std::mt19937 random(99);
  int refused = 0, read = 0;
  for (int round = 0; round < 20000; ++round) {
    std::memcpy(payload.bytes().data(), record.data() + kHeaderLen, header.payload_len);
    for (int k = 0; k < 1 + round % 4; ++k) {
      payload.bytes()[random() % (round % 2 ? 160 : header.payload_len)] = static_cast<std::byte>(random());
    }
    Slice slice;
    const auto len = round % 5 == 0 ? random() % header.payload_len : header.payload_len;
    if (!decode_slice(payload.first(len), slice)) {
      ++refused;
      continue;
    }
    ++read;
    (void)check_slice(slice, kTestLimits);  // reads every point and contour
    REQUIRE(slice.points.size() <= header.payload_len / sizeof(Point));
  }
  MESSAGE(refused << " refused, " << read << " read");
  CHECK(refused > 1000);
  CHECK(read > 1000);
}
