#pragma once
#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/record/recording_transport.h"
#include "host/record/replay/replay_transport.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wire/loopback_bench.h"

namespace sonoloft::test {

/// What a session delivered in one run.
struct Delivered {
  std::vector<std::shared_ptr<const device::DeliveredSlice>> slices;
  device::Ledger ledger;
  std::vector<device::Event> events;
};

/// A run up to its end, lossless.
inline Delivered run_to_end(device::Session& session, device::EventKind end = device::EventKind::end_of_data,
                            std::size_t queue_capacity = 64) {
  Inbox inbox;
  const auto started = session.start({device::StreamMode::lossless, queue_capacity}, inbox.callbacks());
  if (!started) FAIL(started.error().message);
  REQUIRE(inbox.wait_for(end));
  session.stop();
  return {inbox.slices(), session.ledger(), inbox.events()};
}

/// Records one run of `count` slices of the loopback's device.
inline Delivered record_run(const std::filesystem::path& path, std::uint32_t count) {
  device_sim::LoopbackDevice device(loopback_options(), numbered_slices(count));
  const auto recorder = record::Recorder::create(path);
  if (!recorder) FAIL(recorder.error().message);
  auto session = device::Session::open(std::make_unique<record::RecordingTransport>(
      std::make_unique<device::LoopbackTransport>(device.port()), *recorder));
  REQUIRE(session);
  Delivered delivered = run_to_end(**session);
  const auto closed = (*recorder)->close();
  CHECK(closed);
  CHECK((*recorder)->figures().not_recorded == 0);
  return delivered;
}

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline bool same(const device::DeliveredSlice& a, const device::DeliveredSlice& b) {
  return a.slice.id == b.slice.id && a.slice.time == b.slice.time && a.pose_time == b.pose_time &&
         a.pose_status == b.pose_status && a.pose_error_mm == b.pose_error_mm &&
         a.slice.image_to_reference.matrix() == b.slice.image_to_reference.matrix();
}

}  // namespace sonoloft::test
