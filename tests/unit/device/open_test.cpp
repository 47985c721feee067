#include <doctest/doctest.h>

#include <cstring>

#include "host/device/session.h"
#include "protocol/record.h"
#include "protocol/schema_hash.h"
#include "tests/support/wire/scripted_transport.h"

using namespace sonoloft;
using namespace sonoloft::test;
using protocol::Command;
using Answer = ScriptedTransport::Answer;

namespace {

protocol::InfoReply good_info() {
  protocol::InfoReply info{};
  info.major = protocol::kVersion.major;
  info.minor = protocol::kVersion.minor;
  info.max_label = 0xFFFF;
  info.schema_hash = protocol::kSchemaHash;
  info.capabilities = protocol::kCapSlices;
  info.max_record = 65536;
  info.max_points = 0xFFFFFFFF;
  info.max_contours = 0xFFFFFFFF;
  info.ring_capacity = 4;
  return info;
}

Answer answer(const protocol::InfoReply& info, const protocol::RequestView& request) {
  switch (request.command) {
    case Command::get_info:
      return {.payload = payload_of(info)};
    case Command::get_calibration:
      return {.payload = payload_of(protocol::CalibrationMessage{1, 0, {.2, 0, 0, 0, 0, .2, 0, 0, 0, 0, 1, 0}})};
    default:
      return {};
  }
}

Result<std::unique_ptr<device::Session>> open_with(const protocol::InfoReply& info) {
  return device::Session::open(
      std::make_unique<ScriptedTransport>([info](const auto& request) { return answer(info, request); }));
}

Error error_with(auto edit) {
  auto info = good_info();
  edit(info);
  auto session = open_with(info);
  REQUIRE_FALSE(session);
  return session.error();
}

}  // namespace

TEST_CASE("open: what a device says of its size is taken up to our own limits") {
  const auto session = open_with(good_info());
  REQUIRE(session);
  CHECK((*session)->info().max_label == kMaxLabel);
  CHECK((*session)->info().max_points == 1u << 20);
  CHECK((*session)->info().max_contours == 1u << 14);
}

TEST_CASE("open: another major is refused with what we have and what we need") {
  const auto newer = error_with([](auto& i) { i.major = 2, i.minor = 3; });
  CHECK(newer.code == ErrorCode::protocol_mismatch);
  CHECK(newer.message == "protocol version of the device: have 2.3, need 1.x: update this program");
  const auto older = error_with([](auto& i) { i.major = 0; });
  CHECK(older.message.find("update the device's firmware") != std::string::npos);
}

TEST_CASE("open: of a newer minor ours is spoken, and its schema may differ") {
  auto info = good_info();
  info.minor = 9;
  info.schema_hash ^= 1;
  const auto session = open_with(info);
  REQUIRE(session);
  CHECK((*session)->info().version.minor == protocol::kVersion.minor);
}

TEST_CASE("open: the same version with another schema, no slices, and absurd records are refused") {
  CHECK(error_with([](auto& i) { i.schema_hash ^= 1; }).code == ErrorCode::protocol_mismatch);
  CHECK(error_with([](auto& i) { i.capabilities = 0; }).code == ErrorCode::protocol_mismatch);
  CHECK(error_with([](auto& i) { i.max_record = 79; }).code == ErrorCode::protocol_mismatch);
  CHECK(error_with([](auto& i) { i.max_record = 0xFFFFFFFF; }).code == ErrorCode::protocol_mismatch);
}

TEST_CASE("open: names that are not terminated are cut, not run over") {
  auto info = good_info();
  std::memset(info.serial, 'x', sizeof info.serial);
  std::memset(info.firmware_version, 'y', sizeof info.firmware_version);
  const auto session = open_with(info);
  REQUIRE(session);
  CHECK((*session)->info().serial == std::string(40, 'x'));
  CHECK((*session)->info().firmware_version == std::string(24, 'y'));
}

TEST_CASE("open: a device that cannot stream without loss says so before it is started") {
  const auto session = open_with(good_info());
  REQUIRE(session);
  const auto started = (*session)->start({device::StreamMode::lossless, 4}, {});
  REQUIRE_FALSE(started);
  CHECK(started.error().code == ErrorCode::protocol_mismatch);
}

TEST_CASE("open: random answers of a device never do more than fail") {
  std::uint32_t state = 1;
  const auto next = [&state] { return state = state * 1664525u + 1013904223u, state >> 16; };
  int opened = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto session =
        device::Session::open(std::make_unique<ScriptedTransport>([&](const protocol::RequestView& r) -> Answer {
          Answer answer;
          answer.payload = r.command == Command::get_info ? payload_of(good_info()) : std::vector<std::byte>(104);
          for (std::uint32_t i = next() % 4; i > 0; --i) {
            answer.payload[next() % answer.payload.size()] = static_cast<std::byte>(next());
          }
          answer.cut = next() % 8 == 0 ? next() % 8 : 0;
          return answer;
        }));
    opened += session.has_value() ? 1 : 0;
    if (!session) REQUIRE_FALSE(session.error().message.empty());
  }
  CHECK(opened < 2000);
}

TEST_CASE("open: a device that falls silent, at whatever request, is waited for less than 2 s") {
  constexpr std::chrono::seconds kLongest{2};
  bool started = false;
  for (int answers = 0; !started; ++answers) {
    CAPTURE(answers);
    auto made = std::make_unique<ScriptedTransport>([left = answers](const auto& request) mutable -> Answer {
      if (left-- > 0) return answer(good_info(), request);
      return {.failure = Error{ErrorCode::timed_out, "the test is silent"}};
    });
    const ScriptedTransport& transport = *made;
    const auto session = device::Session::open(std::move(made));
    if (!session) {
      REQUIRE(answers < 3);
      continue;
    }
    started = (*session)->start({}, {}).has_value();
    if (!started) CHECK(transport.waited() < kLongest);
  }
}
