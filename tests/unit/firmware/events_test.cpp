#include <doctest/doctest.h>

#include <vector>

#include "protocol/event.h"
#include "tests/support/wire/firmware_bench.h"

using namespace sonoloft::protocol;
using namespace sonoloft::test;

namespace {

constexpr std::uint64_t kNsPerMs = 1'000'000;

std::vector<EventMessage> take_all(FirmwareBench& bench) {
  std::vector<EventMessage> events;
  std::array<std::byte, kEventLen> bytes;
  while (const auto len = bench.firmware.take_event(bytes)) {
    const auto event = parse_event(std::span<const std::byte>(bytes).first(len));
    REQUIRE(event);
    events.push_back(*event);
  }
  return events;
}

bool is(const EventMessage& event, EventKind kind) {
  return event.kind == static_cast<std::uint16_t>(kind);
}

}  // namespace

TEST_CASE("events: a button tells itself, its time and its session, and only while one runs") {
  FirmwareBench bench;
  bench.firmware.button(0, true, kNsPerMs);
  CHECK(take_all(bench).empty());
  REQUIRE(bench.start(StreamMode::live, 99) == Status::ok);
  bench.firmware.button(3, true, 5 * kNsPerMs);
  bench.firmware.button(3, false, 6 * kNsPerMs);
  const auto events = take_all(bench);
  REQUIRE(events.size() == 2);
  for (const std::uint32_t i : {0u, 1u}) {
    CHECK(is(events[i], EventKind::button));
    CHECK(events[i].number == 3);
    CHECK(events[i].value == 1 - i);
    CHECK(events[i].session_id == 99);
    CHECK(events[i].t_device_ns == (5 + i) * kNsPerMs);
    CHECK(events[i].seq == i);
  }
}

TEST_CASE("events: of more than fit the oldest are lost, and the gap says how many") {
  FirmwareBench bench;
  REQUIRE(bench.start() == Status::ok);
  for (std::uint16_t i = 0; i < 40; ++i) bench.firmware.button(i, true, kNsPerMs);
  const auto events = take_all(bench);
  REQUIRE(events.size() == 16);
  for (std::uint32_t i = 0; i < 16; ++i) CHECK(events[i].seq == 24 + i);
}

TEST_CASE("events: a fault, the end of the data and the watchdog are told once each") {
  FirmwareBench bench(2);
  REQUIRE(bench.start(StreamMode::lossless) == Status::ok);
  bench.firmware.end_of_source(kNsPerMs);
  bench.firmware.end_of_source(2 * kNsPerMs);
  for (std::uint32_t i = 0; i < 4; ++i) bench.acquire(i);
  auto events = take_all(bench);
  REQUIRE(events.size() == 2);
  CHECK(is(events[0], EventKind::source_ended));
  CHECK(is(events[1], EventKind::state));
  REQUIRE(bench.tell(Command::stop) == Status::ok);
  REQUIRE(bench.start() == Status::ok);
  for (std::uint64_t later : {2000u, 2100u}) bench.firmware.tick((bench.now_ms + later) * kNsPerMs);
  events = take_all(bench);
  REQUIRE(events.size() == 1);
  CHECK(is(events[0], EventKind::state));
  CHECK(events[0].seq == 0);
}

TEST_CASE("events: what waits at STOP is not told") {
  FirmwareBench bench;
  REQUIRE(bench.start() == Status::ok);
  bench.firmware.button(0, true, kNsPerMs);
  REQUIRE(bench.tell(Command::stop) == Status::ok);
  CHECK(take_all(bench).empty());
}
