#include "device_sim/firmware/firmware.h"

#include <doctest/doctest.h>

#include <limits>
#include <random>
#include <string>

#include "protocol/schema_hash.h"
#include "tests/support/wire/firmware_bench.h"

using namespace sonoloft::protocol;
using namespace sonoloft::test;

namespace {

StatsReply stats_of(FirmwareBench& bench) {
  const auto stats = bench.ask<StatsReply>(Command::get_stats);
  REQUIRE(stats);
  CHECK(stats->next_seq == stats->sent + stats->dropped + stats->ring_used);
  return *stats;
}

DeviceState state_of(FirmwareBench& bench) {
  return static_cast<DeviceState>(stats_of(bench).state);
}
DeviceFault fault_of(FirmwareBench& bench) {
  return static_cast<DeviceFault>(stats_of(bench).fault);
}

}  // namespace

TEST_CASE("firmware: GET_INFO says what the device is and can hold") {
  FirmwareBench bench(5);
  const auto info = bench.ask<InfoReply>(Command::get_info);
  REQUIRE(info);
  CHECK(info->major == kVersion.major);
  CHECK(info->schema_hash == kSchemaHash);
  CHECK(info->capabilities == (kCapSlices | kCapLossless | kCapCalibration | kCapEvents | kCapMasks));
  CHECK(info->ring_capacity == 5);
  CHECK(info->max_points == kTestLimits.max_points);
  CHECK(info->max_record >= max_record_len(kTestLimits));
  CHECK(std::string(info->serial) == "BENCH-1");
}

TEST_CASE("firmware: slices of the largest size fit into a ring slot") {
  FirmwareBench bench(1);
  REQUIRE(bench.start() == Status::ok);
  auto slice = make_wire_slice(1, kTestLimits.max_contours, kTestLimits.max_points / kTestLimits.max_contours);
  slice.field_of_view.resize(kTestLimits.max_points, Point{1, 2});
  bench.firmware.acquire(slice.view(), 1'000'000'000);
  CHECK(stats_of(bench).next_seq == 1);
  Acceptor acceptor(test_agreement());
  AcceptedSlice accepted;
  CHECK(acceptor.accept(bench.take(), accepted) == Reject::none);
}

TEST_CASE("firmware: a mask of the most runs fits into a ring slot, and a host of 1.0 gets none") {
  FirmwareBench bench(1);
  REQUIRE(bench.start() == Status::ok);
  auto masked = make_masked_slice(1, kTestLimits.max_mask_runs, 1);
  masked.mask_runs.assign(kTestLimits.max_mask_runs, {1, 1});
  masked.field_of_view.resize(kTestLimits.max_points, Point{1, 2});
  bench.firmware.acquire(masked.view(), 1'000'000'000);
  Acceptor acceptor(test_agreement());
  AcceptedSlice accepted;
  CHECK(acceptor.accept(bench.take(), accepted) == Reject::none);

  REQUIRE(bench.tell(Command::stop) == Status::ok);
  REQUIRE(bench.start(StreamMode::live, 2, 0) == Status::ok);
  bench.firmware.acquire(masked.view(), 1'000'000'000);
  bench.acquire(1);
  CHECK(stats_of(bench).next_seq == 1);
  CHECK(stats_of(bench).refused == 1);
}

TEST_CASE("firmware: it streams between START and STOP only") {
  FirmwareBench bench;
  bench.acquire(1);
  CHECK(bench.take().empty());
  CHECK(bench.start() == Status::ok);
  CHECK(bench.start() == Status::wrong_state);
  bench.acquire(2);
  CHECK_FALSE(bench.take().empty());
  CHECK(bench.tell(Command::stop) == Status::ok);
  bench.acquire(3);
  CHECK(bench.take().empty());
  CHECK(bench.tell(Command::stop) == Status::ok);
  CHECK(bench.start() == Status::ok);
}

TEST_CASE("firmware: a START that nobody can serve is refused") {
  FirmwareBench bench;
  StartRequest request{1, kSliceStream, 0, 1, 0};
  const auto refused = [&](auto edit) {
    StartRequest bad = request;
    edit(bad);
    return bench.tell(Command::start, bytes_of(bad)) == Status::invalid_parameter;
  };
  CHECK(refused([](auto& r) { r.streams = 0; }));
  CHECK(refused([](auto& r) { r.streams = 3; }));
  CHECK(refused([](auto& r) { r.mode = 2; }));
  CHECK(refused([](auto& r) { r.major = 2; }));
  CHECK(refused([](auto& r) { r.minor = kVersion.minor + 1; }));
  CHECK(bench.tell(Command::start, bytes_of(request).first(8)) == Status::bad_request);
  CHECK(state_of(bench) == DeviceState::idle);
}

TEST_CASE("firmware: a full live ring drops its oldest records and the headers say how many") {
  FirmwareBench bench(4);
  REQUIRE(bench.start() == Status::ok);
  for (std::uint32_t i = 0; i < 10; ++i) bench.acquire(i);
  const auto stats = stats_of(bench);
  CHECK(stats.next_seq == 10);
  CHECK(stats.dropped == 6);
  CHECK(stats.ring_used == 4);
  std::uint64_t expected = 6;
  while (const auto header = bench.take_header()) {
    CHECK(header->seq == expected++);
    CHECK(header->device_dropped_total == 6);
    CHECK(header->ring_used == 10 - expected);
    CHECK(header->ring_capacity == 4);
  }
  CHECK(expected == 10);
}

TEST_CASE("firmware: at every record, what came before was either sent or dropped") {
  FirmwareBench bench(3);
  REQUIRE(bench.start() == Status::ok);
  std::mt19937 random(11);
  std::uint64_t sent = 0, acquired = 0;
  for (int round = 0; round < 2000; ++round) {
    if (random() % 5 < 3) {
      bench.acquire(static_cast<std::uint32_t>(acquired++));
    } else if (const auto header = bench.take_header()) {
      REQUIRE(header->seq == sent + header->device_dropped_total);
      ++sent;
    }
  }
  const auto stats = stats_of(bench);
  CHECK(stats.sent == sent);
  CHECK(stats.next_seq == acquired);
  CHECK(stats.dropped > 100);
  MESSAGE(acquired << " acquired, " << sent << " sent, " << stats.dropped << " dropped");
}

TEST_CASE("firmware: a full lossless ring is a fault, and what it holds is still sent") {
  FirmwareBench bench(4);
  REQUIRE(bench.start(StreamMode::lossless) == Status::ok);
  for (std::uint32_t i = 0; i < 6; ++i) bench.acquire(i);
  auto stats = stats_of(bench);
  CHECK(static_cast<DeviceState>(stats.state) == DeviceState::faulted);
  CHECK(static_cast<DeviceFault>(stats.fault) == DeviceFault::ring_full);
  CHECK(stats.next_seq == 4);
  CHECK(stats.dropped == 0);
  CHECK(stats.refused == 1);
  for (std::uint64_t seq = 0; seq < 4; ++seq) CHECK(bench.take_header()->seq == seq);
  bench.acquire(7);
  CHECK(bench.take().empty());
  CHECK(bench.start() == Status::wrong_state);
  CHECK(bench.tell(Command::stop) == Status::ok);
  CHECK(bench.start() == Status::ok);
  CHECK(fault_of(bench) == DeviceFault::none);
}

TEST_CASE("firmware: slices that break a rule are refused, counted, and take no number") {
  FirmwareBench bench;
  REQUIRE(bench.start() == Status::ok);
  auto bad = make_wire_slice(1);
  bad.points[3].x_px = std::numeric_limits<float>::infinity();
  bench.firmware.acquire(bad.view(), 1'000'000'000);
  auto large = make_wire_slice(1);
  large.contours.resize(kTestLimits.max_contours + 1);
  bench.firmware.acquire(large.view(), 1'000'000'000);
  bench.acquire(2);
  const auto stats = stats_of(bench);
  CHECK(stats.refused == 2);
  CHECK(stats.next_seq == 1);
  CHECK(bench.take_header()->seq == 0);
}

TEST_CASE("firmware: without a request for 1.5 s the device stops by itself") {
  FirmwareBench bench;
  REQUIRE(bench.start() == Status::ok);
  bench.now_ms += 1499;
  bench.acquire(1);
  CHECK(bench.firmware.state() == DeviceState::streaming);
  REQUIRE(bench.ask<HeartbeatReply>(Command::heartbeat));
  bench.now_ms += 1499;
  bench.firmware.tick(bench.now_ms * 1'000'000);
  CHECK(bench.firmware.state() == DeviceState::streaming);
  bench.now_ms += 1;
  bench.firmware.tick(bench.now_ms * 1'000'000);
  CHECK(bench.firmware.state() == DeviceState::idle);
  const auto stats = stats_of(bench);
  CHECK(static_cast<DeviceFault>(stats.fault) == DeviceFault::watchdog);
  CHECK(stats.dropped == 1);
  bench.now_ms += 10'000;  // idle devices wait for ever
  CHECK(bench.start() == Status::ok);
}

TEST_CASE("firmware: the watchdog's time is a parameter with limits") {
  FirmwareBench bench;
  const auto set = [&](std::int64_t ms) { return bench.tell(Command::set_param, bytes_of(ParamMessage{1, 0, ms})); };
  CHECK(bench.ask<ParamMessage>(Command::get_param, bytes_of(ParamMessage{1, 0, 0}))->value == 1500);
  CHECK(set(99) == Status::invalid_parameter);
  CHECK(set(60001) == Status::invalid_parameter);
  CHECK(set(3000) == Status::ok);
  CHECK(bench.tell(Command::get_param, bytes_of(ParamMessage{2, 0, 0})) == Status::invalid_parameter);
  REQUIRE(bench.start() == Status::ok);
  bench.now_ms += 2999;
  bench.firmware.tick(bench.now_ms * 1'000'000);
  CHECK(bench.firmware.state() == DeviceState::streaming);
}

TEST_CASE("firmware: a calibration is kept while idle and refused while streaming or when it is nonsense") {
  FirmwareBench bench;
  CalibrationMessage calibration{99, 0, {0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 1, 0}};
  CHECK(bench.tell(Command::set_calibration, bytes_of(calibration)) == Status::ok);
  CHECK(bench.ask<CalibrationMessage>(Command::get_calibration)->id == 99);
  calibration.image_to_probe[7] = std::numeric_limits<double>::quiet_NaN();
  CHECK(bench.tell(Command::set_calibration, bytes_of(calibration)) == Status::invalid_parameter);
  CHECK(bench.tell(Command::set_calibration, bytes_of(calibration).first(100)) == Status::bad_request);
  calibration = {0, 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
  CHECK(bench.tell(Command::set_calibration, bytes_of(calibration)) == Status::invalid_parameter);
  REQUIRE(bench.start() == Status::ok);
  calibration.id = 100;
  CHECK(bench.tell(Command::set_calibration, bytes_of(calibration)) == Status::wrong_state);
  CHECK(bench.tell(Command::reset) == Status::ok);
  CHECK(bench.ask<CalibrationMessage>(Command::get_calibration)->id == 99);
}

TEST_CASE("firmware: TIME_SYNC latches the device's clock, RESET forgets everything but the calibration") {
  FirmwareBench bench;
  bench.now_ms = 123456;
  const auto sync = bench.ask<TimeSyncReply>(Command::time_sync, bytes_of(TimeSyncRequest{42}));
  REQUIRE(sync);
  CHECK(sync->host_ns == 42);
  CHECK(sync->device_ns == 123456'000000);
  REQUIRE(bench.start() == Status::ok);
  bench.acquire(1);
  CHECK(bench.tell(Command::reset) == Status::ok);
  const auto stats = stats_of(bench);
  CHECK(stats.next_seq == 0);
  CHECK(stats.session_id == 0);
  CHECK(bench.firmware.state() == DeviceState::idle);
}

TEST_CASE("firmware: the end of the source shows until the next START") {
  FirmwareBench bench;
  bench.firmware.end_of_source(1);
  CHECK(bench.ask<HeartbeatReply>(Command::heartbeat)->flags == 0);
  REQUIRE(bench.start() == Status::ok);
  bench.firmware.end_of_source(1);
  CHECK(bench.ask<HeartbeatReply>(Command::heartbeat)->flags == kStatsSourceEnded);
  CHECK(bench.tell(Command::stop) == Status::ok);
  REQUIRE(bench.start() == Status::ok);
  CHECK(bench.ask<HeartbeatReply>(Command::heartbeat)->flags == 0);
}

TEST_CASE("firmware: any bytes for a request get an answer and unknown commands are said to be unknown") {
  FirmwareBench bench;
  CHECK(bench.tell(static_cast<Command>(15)) == Status::not_implemented);
  CHECK(bench.tell(static_cast<Command>(0)) == Status::not_implemented);
  std::array<std::byte, 64> noise{};
  std::mt19937 random(5);
  std::array<int, 7> answers{};
  for (int round = 0; round < 20000; ++round) {
    for (auto& b : noise) b = static_cast<std::byte>(random() % 14);
    noise[1] = noise[3] = std::byte{0};
    const std::size_t len = random() % 3 == 0 ? random() % noise.size() : 8 + static_cast<std::size_t>(noise[2]);
    const auto status = static_cast<std::size_t>(bench.send(std::span(noise).first(len)).status);
    REQUIRE(status < answers.size());
    ++answers[status];
    bench.acquire(1);
  }
  CHECK(answers[static_cast<std::size_t>(Status::ok)] > 100);
  CHECK(answers[static_cast<std::size_t>(Status::bad_request)] > 100);
  CHECK(answers[static_cast<std::size_t>(Status::not_implemented)] > 100);
}
