#include "protocol/command.h"

#include <doctest/doctest.h>

#include <array>
#include <string>

using namespace sonoloft::protocol;

TEST_CASE("command: requests and replies come back as they were sent") {
  std::array<std::byte, kMaxRequestLen> wire;
  const StartRequest start{0xCAFE0001, kSliceStream, 1, 1, 0};
  const auto request_len = encode_request(Command::start, 77, bytes_of(start), wire);
  CHECK(request_len == 8 + sizeof start);
  const auto request = parse_request(std::span(wire).first(request_len));
  REQUIRE(request);
  CHECK(request->command == Command::start);
  CHECK(request->request_id == 77);
  StartRequest read;
  REQUIRE(read_payload(request->payload, read));
  CHECK(read.session_id == start.session_id);
  CHECK(read.mode == start.mode);

  const auto reply_len = encode_reply(Status::wrong_state, 77, {}, wire);
  const auto reply = parse_reply(std::span(wire).first(reply_len));
  REQUIRE(reply);
  CHECK(reply->status == Status::wrong_state);
  CHECK(reply->request_id == 77);
  CHECK(reply->payload.empty());
}

TEST_CASE("command: bytes that are not as long as they say are refused") {
  std::array<std::byte, kMaxRequestLen + 8> wire{};
  const auto len = encode_request(Command::time_sync, 1, bytes_of(TimeSyncRequest{5}), wire);
  for (std::size_t n = 0; n < 64; ++n) {
    CHECK(parse_request(std::span(wire).first(n)).has_value() == (n == len));
  }
  const std::array<std::byte, kMaxRequestLen - 8> most{};
  CHECK(encode_reply(Status::ok, 2, most, wire) == kMaxRequestLen);
  CHECK(parse_reply(std::span(wire).first(kMaxRequestLen)));
  CHECK_FALSE(parse_reply(wire));
}

TEST_CASE("command: a payload of a later minor is read as far as it is known, a shorter one not at all") {
  std::array<std::byte, 64> payload{};
  HeartbeatReply beat;
  CHECK(read_payload(std::span<const std::byte>(payload).first(sizeof beat + 8), beat));
  CHECK_FALSE(read_payload(std::span<const std::byte>(payload).first(sizeof beat - 1), beat));
}

TEST_CASE("command: majors must be equal, of the minors the lower is spoken") {
  CHECK_FALSE(common_version({1, 0}, {2, 0}));
  CHECK_FALSE(common_version({1, 9}, {0, 9}));
  const auto common = common_version({1, 4}, {1, 2});
  REQUIRE(common);
  CHECK(common->major == 1);
  CHECK(common->minor == 2);
  CHECK(common_version({1, 2}, {1, 4})->minor == 2);
}

TEST_CASE("command: every status has a name, and so has none") {
  for (std::uint16_t i = 0; i <= 6; ++i) CHECK(std::string(name(static_cast<Status>(i))) != "unknown status");
  CHECK(std::string(name(static_cast<Status>(7))) == "unknown status");
}
