#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "protocol/block.h"
#include "protocol/command.h"
#include "protocol/event.h"
#include "tests/support/wire/wire_slices.h"

using namespace sonoloft::protocol;
using namespace sonoloft::test;

// The committed bytes are the wire. When one of these tests fails, either the change is a mistake, or it is a new
// version of the protocol: then add a golden file for it and keep the old one.

namespace {

using Bytes = std::vector<std::byte>;

// Lines of hexadecimal bytes; # begins a comment.
Bytes read_hex(const std::string& path) {
  std::ifstream file(path);
  REQUIRE_MESSAGE(file.good(), path);
  Bytes bytes;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (std::string word; words >> word;) bytes.push_back(static_cast<std::byte>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    char digits[4];
    std::snprintf(digits, sizeof digits, "%02x%c", static_cast<unsigned>(bytes[i]), i % 16 == 15 ? '\n' : ' ');
    text += digits;
  }
  return text;
}

void check_equal(std::span<const std::byte> ours, const std::string& path) {
  const Bytes golden = read_hex(path);
  const bool equal = std::equal(ours.begin(), ours.end(), golden.begin(), golden.end());
  CHECK_MESSAGE(equal, path << " differs; now it would be\n" << hex(ours));
}

OwnedWireSlice golden_slice() {
  OwnedWireSlice owned;
  owned.points = {{1, 2}, {3.5f, 2}, {3.5f, 4.25f}, {10, 10}, {20, 10}, {20, 20}, {10, 20}};
  owned.contours = {{0, 3, 2, 0}, {3, 4, kUnknownLabel, 0}};
  owned.field_of_view = {{0, 0}, {640, 0}, {320, 480}};
  owned.slice.pose = {0.5, 0.5, -0.5, 0.5, 12.5, -3.25, 100.0};
  owned.slice.pose.time_ns = 0x1122334455667788;
  owned.slice.pose.error_mm = 0.125f;
  owned.slice.pose.status = PoseStatus::high_error;
  owned.slice.time_ns = 0x0102030405060708;
  owned.slice.calibration_id = 0xCA11B007;
  return owned;
}

OwnedWireSlice golden_mask() {
  OwnedWireSlice owned = golden_slice();
  owned.points.clear();
  owned.contours.clear();
  owned.slice.mask_grid = {-1.5f, 8, 0.25f, 5, 3};
  owned.mask_runs = {{7, 0}, {4, 2}, {1, kUnknownLabel}, {3, 0}};
  return owned;
}

// A record of a committed file, as a reader of its version and schema would take it.
AcceptedSlice read_record(AlignedBytes& transfer) {
  const auto bytes = transfer.bytes();
  RecordHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  Agreement agreed = test_agreement(0x5E551014);
  agreed.minor = header.minor;
  agreed.schema_hash = header.schema_hash;
  Acceptor acceptor(agreed);
  AcceptedSlice accepted;
  REQUIRE(acceptor.accept(bytes, accepted) == Reject::none);
  return accepted;
}

AlignedBytes aligned(const Bytes& bytes) {
  AlignedBytes copy(bytes.size());
  std::memcpy(copy.bytes().data(), bytes.data(), bytes.size());
  return copy;
}

struct Committed {
  const char* record;
  int minor;
};
constexpr Committed kRecords[] = {{"tests/golden/slice_record_v1.hex", 0}, {"tests/golden/slice_record_v1_1.hex", 1}};

template <class T>
T number_at(const Bytes& bytes, std::size_t offset) {
  T value;
  REQUIRE(offset + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("golden: records of slices with contours and with a mask are the committed bytes") {
  auto owned = golden_slice();
  check_equal(make_record(owned.view(), 0x0000000500000006, 0x5E551014), "tests/golden/slice_record_v1_1.hex");
  auto masked = golden_mask();
  check_equal(make_record(masked.view(), 0x0000000500000006, 0x5E551014), "tests/golden/mask_record_v1_1.hex");
}

TEST_CASE("golden: the committed records of every version are read as the slices they were made of") {
  for (const Committed& version : kRecords) {
    auto transfer = aligned(read_hex(version.record));
    auto owned = golden_slice();
    CHECK(same(read_record(transfer).slice, owned.view()));
  }
  auto transfer = aligned(read_hex("tests/golden/mask_record_v1_1.hex"));
  auto masked = golden_mask();
  CHECK(same(read_record(transfer).slice, masked.view()));
}

TEST_CASE("golden: every header and trailer number stands where docs/protocol.md says") {
  for (const Committed& version : kRecords) {
    const Bytes golden = read_hex(version.record);
    REQUIRE(golden.size() >= 80);
    CHECK(std::memcmp(golden.data(), "SONO", 4) == 0);
    CHECK(number_at<std::uint16_t>(golden, 4) == 64);
    CHECK(number_at<std::uint8_t>(golden, 6) == 1);
    CHECK(number_at<std::uint8_t>(golden, 7) == version.minor);
    CHECK(number_at<std::uint16_t>(golden, 8) == 1);
    CHECK(number_at<std::uint16_t>(golden, 10) == 0);
    CHECK(number_at<std::uint32_t>(golden, 12) == 0);
    CHECK(number_at<std::uint32_t>(golden, 16) == golden.size());
    CHECK(number_at<std::uint32_t>(golden, 20) <= golden.size() - 80);
    CHECK(number_at<std::uint64_t>(golden, 24) == 0x0000000500000006);
    CHECK(number_at<std::uint64_t>(golden, 32) == 0x0102030405060708);
    CHECK(number_at<std::uint32_t>(golden, 40) == 0x5E551014);
    CHECK(number_at<std::uint32_t>(golden, 44) == 3);
    CHECK(number_at<std::uint16_t>(golden, 52) == 2);
    CHECK(number_at<std::uint16_t>(golden, 54) == 16);
    CHECK(number_at<std::uint32_t>(golden, 56) == 0);
    CHECK(number_at<std::uint32_t>(golden, golden.size() - 12) == 6);
    CHECK(number_at<std::uint32_t>(golden, golden.size() - 8) == 0);
    CHECK(std::memcmp(golden.data() + golden.size() - 4, "LOFT", 4) == 0);
  }
}

TEST_CASE("golden: requests and replies of 1.0 are the committed bytes") {
  InfoReply info{1, 0, 9, 0xAABBCCDD, 3, 65536, 4096, 64, 16, 0, 1000, "0.1.0", "SIM-0001", 0, 0, 0, 0};
  CalibrationMessage calibration{0xCA11B007, 0, {0.2, 0, 0, -64, 0, 0.25, 0, -10, 0, 0, 1, 5}};
  Bytes all;
  std::array<std::byte, kMaxRequestLen> wire;
  const auto add = [&](std::size_t len) { all.insert(all.end(), wire.begin(), wire.begin() + static_cast<long>(len)); };
  add(encode_request(Command::get_info, 1, {}, wire));
  add(encode_reply(Status::ok, 1, bytes_of(info).first(kInfoReplyLen_1_0), wire));
  add(encode_request(Command::start, 2, bytes_of(StartRequest{0x5E551014, kSliceStream, 1, 1, 0}), wire));
  add(encode_reply(Status::wrong_state, 2, {}, wire));
  add(encode_reply(Status::ok, 3, bytes_of(StatsReply{0x5E551014, 1, 2, 11, 7, 3, 5, 1, 1}), wire));
  add(encode_request(Command::time_sync, 4, bytes_of(TimeSyncRequest{0x0102030405060708}), wire));
  add(encode_reply(Status::ok, 4, bytes_of(TimeSyncReply{0x0102030405060708, 0x1112131415161718}), wire));
  add(encode_reply(Status::ok, 5, bytes_of(HeartbeatReply{2, 1, 1, 9}), wire));
  add(encode_request(Command::set_param, 6, bytes_of(ParamMessage{1, 0, 3000}), wire));
  add(encode_request(Command::set_calibration, 7, bytes_of(calibration), wire));
  add(encode_reply(Status::pending, 8, bytes_of(PendingReply{250}), wire));
  check_equal(all, "tests/golden/messages_v1.hex");
}

TEST_CASE("golden: what 1.1 added is the committed bytes") {
  const InfoReply info{1, 1,    9,       0xAABBCCDD, 0x3B,  65536,   4096,    64,  16,
                       0, 1000, "0.2.0", "SIM-0001", 32768, 1 << 20, 1 << 24, 4096};
  Bytes all;
  std::array<std::byte, kMaxRequestLen> wire;
  const auto add = [&](std::size_t len) { all.insert(all.end(), wire.begin(), wire.begin() + static_cast<long>(len)); };
  add(encode_reply(Status::ok, 1, bytes_of(info), wire));
  add(encode_request(Command::begin_blob, 2, bytes_of(BeginBlobRequest{1, 70000, 0xE3069283, 0}), wire));
  add(encode_reply(Status::ok, 3, bytes_of(BlobReply{1, 70000, 4064, 1, 0}), wire));
  add(encode_request(Command::keep_blob, 4, {}, wire));
  const EventMessage event = seal_event({0, 3, 2, 1, 0x5E551014, 0x0102030405060708, 5, 0});
  all.insert(all.end(), bytes_of(event).begin(), bytes_of(event).end());
  const Bytes data(48, std::byte{0x5A});
  add(encode_block({4064, data}, wire));
  check_equal(all, "tests/golden/messages_v1_1.hex");
}

TEST_CASE("golden: a GET_INFO reply of 1.0 is read, with nothing of what 1.1 added") {
  const Bytes golden = read_hex("tests/golden/messages_v1.hex");
  const auto reply = parse_reply(std::span(golden).subspan(8, sizeof(ReplyHeader) + kInfoReplyLen_1_0));
  REQUIRE(reply);
  InfoReply info;
  REQUIRE(read_payload(reply->payload, info));
  CHECK(info.max_points == 4096);
  CHECK(std::string(info.serial) == "SIM-0001");
  CHECK(info.max_mask_runs == 0);
  CHECK(info.max_blob == 0);
  CHECK_FALSE(read_payload(reply->payload.first(kInfoReplyLen_1_0 - 1), info));
}
