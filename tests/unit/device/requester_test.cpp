#include "host/device/requester.h"

#include <doctest/doctest.h>

#include "tests/support/wire/scripted_transport.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::Requester;
using protocol::Command;
using protocol::Status;
using Answer = ScriptedTransport::Answer;

namespace {

ErrorCode code_of(const Answer& answer) {
  ScriptedTransport transport([&](const auto&) { return answer; });
  Requester requester(transport);
  const auto reply = requester.ask<protocol::HeartbeatReply>(Command::heartbeat, {}, std::chrono::milliseconds(30));
  REQUIRE_FALSE(reply);
  CHECK(reply.error().message.find('\n') == std::string::npos);
  CHECK(reply.error().message.find(':') != std::string::npos);
  return reply.error().code;
}

}  // namespace

TEST_CASE("requester: a sound reply gives its payload, also when a later minor made it longer") {
  std::vector<std::byte> longer = payload_of(protocol::HeartbeatReply{1, 0, 0, 5});
  longer.resize(longer.size() + 12);
  ScriptedTransport transport([&](const auto&) { return Answer{.payload = longer}; });
  Requester requester(transport);
  const auto reply = requester.ask<protocol::HeartbeatReply>(Command::heartbeat);
  REQUIRE(reply);
  CHECK(reply->ring_used == 5);
}

TEST_CASE("requester: a device that says busy or pending is asked the same again until it answers") {
  int asked = 0;
  std::uint32_t first_id = 0;
  ScriptedTransport transport([&](const protocol::RequestView& request) -> Answer {
    if (asked == 0) first_id = request.request_id;
    CHECK(request.request_id == first_id);
    ++asked;
    if (asked == 1) return {Status::busy, {}};
    if (asked == 2) return {Status::pending, payload_of(protocol::PendingReply{5})};
    if (asked == 3) return {Status::pending, {}};
    return {Status::ok, payload_of(protocol::HeartbeatReply{1, 0, 0, 5})};
  });
  Requester requester(transport);
  CHECK(requester.ask<protocol::HeartbeatReply>(Command::heartbeat));
  CHECK(asked == 4);
}

TEST_CASE("requester: every way to answer badly is an error of its own kind, never a wrong answer") {
  CHECK(code_of({Status::busy, {}}) == ErrorCode::timed_out);
  CHECK(code_of({Status::pending, payload_of(protocol::PendingReply{0xFFFFFFFF})}) == ErrorCode::timed_out);
  CHECK(code_of({Status::wrong_state, {}}) == ErrorCode::wrong_state);
  CHECK(code_of({Status::not_implemented, {}}) == ErrorCode::not_available);
  CHECK(code_of({Status::invalid_parameter, {}}) == ErrorCode::refused_by_device);
  CHECK(code_of({static_cast<Status>(999), {}}) == ErrorCode::refused_by_device);
  CHECK(code_of({Status::ok, std::vector<std::byte>(3)}) == ErrorCode::protocol_mismatch);
  CHECK(code_of({.payload = std::vector<std::byte>(8), .id_offset = -1}) == ErrorCode::protocol_mismatch);
  CHECK(code_of({.payload = std::vector<std::byte>(8), .cut = 1}) == ErrorCode::protocol_mismatch);
  CHECK(code_of({.payload = {}, .cut = 8}) == ErrorCode::protocol_mismatch);
  CHECK(code_of({.payload = {}, .failure = Error{ErrorCode::io_failed, "x: y"}}) == ErrorCode::io_failed);
}
