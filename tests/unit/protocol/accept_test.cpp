#include "protocol/accept.h"

#include <doctest/doctest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "protocol/crc32c.h"
#include "tests/support/wire/wire_slices.h"

using namespace sonoloft::protocol;
using namespace sonoloft::test;

namespace {

using Bytes = std::vector<std::byte>;

RecordHeader header_of(const Bytes& record) {
  RecordHeader header;
  std::memcpy(&header, record.data(), sizeof header);
  return header;
}

// Changes the header and sums it up again, as a device with that defect would.
void edit_header(Bytes& record, const std::function<void(RecordHeader&)>& edit) {
  RecordHeader header = header_of(record);
  edit(header);
  std::memcpy(record.data(), &header, sizeof header);
  header.header_crc32c = crc32c(std::span<const std::byte>(record).first(60));
  std::memcpy(record.data(), &header, sizeof header);
}

void edit_trailer(Bytes& record, const std::function<void(RecordTrailer&)>& edit) {
  RecordTrailer trailer;
  std::memcpy(&trailer, record.data() + record.size() - kTrailerLen, sizeof trailer);
  edit(trailer);
  std::memcpy(record.data() + record.size() - kTrailerLen, &trailer, sizeof trailer);
}

void sum_payload(Bytes& record) {
  const auto body = std::span<const std::byte>(record).subspan(64, record.size() - 64 - 16);
  edit_trailer(record, [&](RecordTrailer& t) { t.payload_crc32c = crc32c(body); });
}

Bytes good_record() {
  auto owned = make_wire_slice(2, 3, 20);
  return make_record(owned.view(), 41);
}

Bytes record_without_meaning() {
  auto owned = make_wire_slice(2, 3, 20);
  owned.points[5].x_px = std::numeric_limits<float>::quiet_NaN();
  return make_record(owned.view(), 41);
}

struct Outcome {
  Reject reason;
  Acceptor acceptor;
};

Outcome run(const Bytes& record, std::size_t offset = 0) {
  AlignedBytes transfer(record.size() + offset);
  if (!record.empty()) std::memcpy(transfer.bytes().data() + offset, record.data(), record.size());
  Acceptor acceptor(test_agreement());
  AcceptedSlice accepted;
  const Reject reason = acceptor.accept(transfer.bytes().subspan(offset), accepted);
  return {reason, acceptor};
}

struct Case {
  const char* what;
  Reject reason;
  std::function<void(Bytes&)> spoil;
};

const Case kCases[] = {
    {"nothing", Reject::length, [](Bytes& r) { r.clear(); }},
    {"half a header", Reject::length, [](Bytes& r) { r.erase(r.begin() + 32, r.end()); }},
    {"one byte less than header and trailer", Reject::length, [](Bytes& r) { r.erase(r.begin() + 79, r.end()); }},
    {"longer than max_record", Reject::length, [](Bytes& r) { r.resize((1u << 20) + 1); }},
    {"another magic", Reject::magic, [](Bytes& r) { edit_header(r, [](auto& h) { h.magic ^= 0x20; }); }},
    {"a header sum that is wrong", Reject::header_crc, [](Bytes& r) { r[60] ^= std::byte{1}; }},
    {"a header number altered on the way", Reject::header_crc, [](Bytes& r) { r[24] ^= std::byte{0x80}; }},
    {"the next major", Reject::version, [](Bytes& r) { edit_header(r, [](auto& h) { ++h.major; }); }},
    {"a minor that was not agreed on", Reject::version, [](Bytes& r) { edit_header(r, [](auto& h) { ++h.minor; }); }},
    {"an unknown incompatible feature", Reject::version,
     [](Bytes& r) { edit_header(r, [](auto& h) { h.incompat = 0x80; }); }},
    {"another schema", Reject::version, [](Bytes& r) { edit_header(r, [](auto& h) { h.schema_hash ^= 1; }); }},
    {"a transfer cut short", Reject::lengths, [](Bytes& r) { r.erase(r.end() - 16, r.end()); }},
    {"a transfer with a tail", Reject::lengths, [](Bytes& r) { r.push_back(std::byte{0}); }},
    {"a header shorter than a header", Reject::lengths,
     [](Bytes& r) { edit_header(r, [](auto& h) { h.header_len = 48; }); }},
    {"a header length between the steps", Reject::lengths,
     [](Bytes& r) { edit_header(r, [](auto& h) { h.header_len = 72; }); }},
    {"a header longer than any", Reject::lengths,
     [](Bytes& r) { edit_header(r, [](auto& h) { h.header_len = 0xFFF0; }); }},
    {"a payload that overflows 32 bits", Reject::lengths,
     [](Bytes& r) { edit_header(r, [](auto& h) { h.payload_len = 0xFFFFFFFF; }); }},
    {"a payload shorter than its room", Reject::lengths,
     [](Bytes& r) { edit_header(r, [](auto& h) { h.payload_len -= 64; }); }},
    {"another session", Reject::session, [](Bytes& r) { edit_header(r, [](auto& h) { ++h.session_id; }); }},
    {"a type that was not started", Reject::session,
     [](Bytes& r) { edit_header(r, [](auto& h) { h.type = static_cast<std::uint16_t>(RecordType::log); }); }},
    {"a stream that was not started", Reject::session, [](Bytes& r) { edit_header(r, [](auto& h) { h.stream = 3; }); }},
    {"no end", Reject::trailer, [](Bytes& r) { edit_trailer(r, [](auto& t) { t.end_magic = 0; }); }},
    {"the end of another record", Reject::trailer, [](Bytes& r) { edit_trailer(r, [](auto& t) { ++t.seq_low; }); }},
    {"spoiled, says the device", Reject::trailer, [](Bytes& r) { edit_trailer(r, [](auto& t) { t.status = 1; }); }},
    {"a payload altered on the way", Reject::payload_crc, [](Bytes& r) { r[200] ^= std::byte{4}; }},
    {"padding altered on the way", Reject::payload_crc, [](Bytes& r) { r[r.size() - 17] ^= std::byte{4}; }},
    {"a root that points outside", Reject::verifier,
     [](Bytes& r) {
       const std::uint32_t far = 0x7FFFFFF0;
       std::memcpy(r.data() + 64, &far, 4);
       sum_payload(r);
     }},
    {"a payload of zeros", Reject::verifier,
     [](Bytes& r) {
       std::fill(r.begin() + 64, r.end() - 16, std::byte{0});
       sum_payload(r);
     }},
    {"a point that is no number", Reject::meaning, [](Bytes& r) { r = record_without_meaning(); }},
};

}  // namespace

TEST_CASE("accept: every defect is found by its own check and counted there alone") {
  std::array<int, kRejectCount> hits{};
  for (const Case& c : kCases) {
    CAPTURE(c.what);
    Bytes record = good_record();
    c.spoil(record);
    const Outcome outcome = run(record);
    CHECK(name(outcome.reason) == std::string(name(c.reason)));
    ++hits[static_cast<std::size_t>(outcome.reason)];
    for (std::size_t i = 0; i < kRejectCount; ++i) {
      CHECK(outcome.acceptor.count(static_cast<Reject>(i)) == (static_cast<Reject>(i) == c.reason ? 1 : 0));
    }
  }
  const Outcome crooked = run(good_record(), 8);
  CHECK(crooked.reason == Reject::alignment);
  CHECK(run(good_record()).reason == Reject::none);
  ++hits[static_cast<std::size_t>(crooked.reason)];
  for (std::size_t i = 1; i < kRejectCount; ++i) CHECK(hits[i] >= 1);
  MESSAGE((std::size(kCases) + 1) << " kinds of bad records");
}

TEST_CASE("accept: earlier checks come first when several things are wrong") {
  Bytes record = record_without_meaning();
  Reject last = run(record).reason;
  CHECK(last == Reject::meaning);
  const auto expect = [&](Reject reason, const std::function<void(Bytes&)>& spoil) {
    spoil(record);
    CHECK(run(record).reason == reason);
    CHECK(static_cast<int>(reason) < static_cast<int>(last));
    last = reason;
  };
  expect(Reject::verifier, [](Bytes& r) {
    std::memset(r.data() + 64, 0, 4);
    sum_payload(r);
  });
  CHECK(run(record, 4).reason == Reject::alignment);
  expect(Reject::payload_crc, [](Bytes& r) { r[100] ^= std::byte{1}; });
  expect(Reject::trailer, [](Bytes& r) { edit_trailer(r, [](auto& t) { t.end_magic = 1; }); });
  expect(Reject::session, [](Bytes& r) { edit_header(r, [](auto& h) { h.session_id = 0; }); });
  expect(Reject::lengths, [](Bytes& r) { edit_header(r, [](auto& h) { ++h.total_len; }); });
  expect(Reject::version, [](Bytes& r) { edit_header(r, [](auto& h) { h.major = 9; }); });
  expect(Reject::header_crc, [](Bytes& r) { r[63] ^= std::byte{1}; });
  expect(Reject::magic, [](Bytes& r) { r[0] ^= std::byte{1}; });
  expect(Reject::length, [](Bytes& r) { r.erase(r.begin() + 10, r.end()); });
}

TEST_CASE("accept: no bit can be flipped anywhere without being noticed") {
  const Bytes good = good_record();
  AlignedBytes transfer(good.size());
  Acceptor acceptor(test_agreement());
  AcceptedSlice accepted;
  int flips = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit, ++flips) {
      std::memcpy(transfer.bytes().data(), good.data(), good.size());
      transfer.bytes()[i] ^= static_cast<std::byte>(1 << bit);
      REQUIRE(acceptor.accept(transfer.bytes(), accepted) != Reject::none);
    }
  }
  MESSAGE(flips << " flips of " << good.size() << " bytes");
  CHECK(acceptor.count(Reject::none) == 0);
}

TEST_CASE("accept: no piece of a record and no record with a tail is a record") {
  const Bytes good = good_record();
  AlignedBytes transfer(good.size() + 200);
  std::memcpy(transfer.bytes().data(), good.data(), good.size());
  Acceptor acceptor(test_agreement());
  AcceptedSlice accepted;
  for (std::size_t len = 0; len <= good.size() + 200; ++len) {
    const Reject reason = acceptor.accept(transfer.first(len), accepted);
    REQUIRE((reason == Reject::none) == (len == good.size()));
  }
}

TEST_CASE("accept: a longer header of a later minor is skipped, its tail still under the payload's sum") {
  const Bytes good = good_record();
  const RecordHeader old = header_of(good);
  Bytes longer(good.begin(), good.begin() + 64);
  longer.resize(64 + 32, std::byte{0xAB});
  longer.insert(longer.end(), good.begin() + 64, good.begin() + 64 + old.payload_len);
  longer.resize((longer.size() + 15) / 16 * 16);
  if ((longer.size() + 16) % 64 == 0) longer.resize(longer.size() + 16);
  longer.insert(longer.end(), good.end() - 16, good.end());
  edit_header(longer, [&](auto& h) {
    h.header_len = 96;
    h.total_len = static_cast<std::uint32_t>(longer.size());
  });
  sum_payload(longer);
  CHECK(run(longer).reason == Reject::none);
  longer[70] ^= std::byte{1};
  CHECK(run(longer).reason == Reject::payload_crc);
}

TEST_CASE("accept: compatible features and flags that are not known are ignored") {
  Bytes record = good_record();
  edit_header(record, [](auto& h) {
    h.compat = 0xFF;
    h.flags = 0xFFFF;
  });
  CHECK(run(record).reason == Reject::none);
}
