#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "protocol/command.h"
#include "tests/support/wire_slices.h"

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

template <class T>
T number_at(const Bytes& bytes, std::size_t offset) {
  T value;
  REQUIRE(offset + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

TEST_CASE("golden: a slice record is the committed bytes") {
  auto owned = golden_slice();
  check_equal(make_record(owned.view(), 0x0000000500000006, 0x5E551014), "tests/golden/slice_record_v1.hex");
}

TEST_CASE("golden: the committed slice record is read as the slice it was made of") {
  const Bytes golden = read_hex("tests/golden/slice_record_v1.hex");
  AlignedBytes transfer(golden.size());
  std::memcpy(transfer.bytes().data(), golden.data(), golden.size());
  Acceptor acceptor(test_agreement(0x5E551014));
  AcceptedSlice accepted;
  REQUIRE(acceptor.accept(transfer.bytes(), accepted) == Reject::none);
  auto owned = golden_slice();
  CHECK(same(accepted.slice, owned.view()));
}

TEST_CASE("golden: every header and trailer number stands where docs/protocol.md says") {
  const Bytes golden = read_hex("tests/golden/slice_record_v1.hex");
  REQUIRE(golden.size() >= 80);
  CHECK(std::memcmp(golden.data(), "SONO", 4) == 0);
  CHECK(number_at<std::uint16_t>(golden, 4) == 64);
  CHECK(number_at<std::uint8_t>(golden, 6) == 1);
  CHECK(number_at<std::uint8_t>(golden, 7) == 0);
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

TEST_CASE("golden: requests and replies are the committed bytes") {
  InfoReply info{1, 0, 9, 0xAABBCCDD, 3, 65536, 4096, 64, 16, 0, 1000, "0.1.0", "SIM-0001"};
  CalibrationMessage calibration{0xCA11B007, 0, {0.2, 0, 0, -64, 0, 0.25, 0, -10, 0, 0, 1, 5}};
  Bytes all;
  std::array<std::byte, kMaxRequestLen> wire;
  const auto add = [&](std::size_t len) { all.insert(all.end(), wire.begin(), wire.begin() + static_cast<long>(len)); };
  add(encode_request(Command::get_info, 1, {}, wire));
  add(encode_reply(Status::ok, 1, bytes_of(info), wire));
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
