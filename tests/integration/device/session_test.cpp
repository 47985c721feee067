#include "host/device/session.h"

#include <doctest/doctest.h>

#include <future>
#include <optional>
#include <stdexcept>
#include <thread>

#include "tests/support/wire/loopback_bench.h"

using namespace sonoloft;
using namespace sonoloft::test;
using device::EventKind;
using device::StreamMode;

namespace {

constexpr device::StreamOptions kLossless{StreamMode::lossless, 16};

// p_reference of a pixel, straight from the wire's definition.
Eigen::Vector3d pixel_to_reference(const protocol::Pose& pose, const protocol::Point& p) {
  const auto calibration = test_calibration();
  const auto m = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(calibration.image_to_probe);
  const Eigen::Vector3d probe = m * Eigen::Vector4d(p.x_px, p.y_px, 0, 1);
  return Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz) * probe +
         Eigen::Vector3d(pose.tx_mm, pose.ty_mm, pose.tz_mm);
}

// The largest distance, in mm, between what was sent and what arrived; everything else must be equal.
double deviation_mm(const device::DeliveredSlice& delivered) {
  auto sent = make_wire_slice(static_cast<std::uint32_t>(delivered.slice.id));
  const auto& slice = delivered.slice;
  REQUIRE(slice.points.size() == sent.points.size());
  REQUIRE(slice.field_of_view.size() == sent.field_of_view.size());
  REQUIRE(slice.contours.size() == sent.contours.size());
  REQUIRE(delivered.pose_status == sent.slice.pose.status);
  REQUIRE(delivered.pose_error_mm == sent.slice.pose.error_mm);
  REQUIRE(delivered.pose_time.count() == static_cast<long>(sent.slice.pose.time_ns));
  REQUIRE(slice.time.count() == static_cast<long>(sent.slice.time_ns));
  for (std::size_t i = 0; i < slice.contours.size(); ++i) {
    REQUIRE(slice.contours[i].first == sent.contours[i].first);
    REQUIRE(slice.contours[i].count == sent.contours[i].count);
    REQUIRE(slice.contours[i].label == sent.contours[i].label);
    REQUIRE(slice.contours[i].hole == (sent.contours[i].flags == protocol::kHoleFlag));
  }
  double largest = 0;
  const auto compare = [&](const Eigen::Vector2d& p_mm, const protocol::Point& p) {
    const Eigen::Vector3d here = slice.image_to_reference * Eigen::Vector3d(p_mm.x(), p_mm.y(), 0);
    largest = std::max(largest, (here - pixel_to_reference(sent.slice.pose, p)).norm());
  };
  for (std::size_t i = 0; i < slice.points.size(); ++i) compare(slice.points[i], sent.points[i]);
  for (std::size_t i = 0; i < slice.field_of_view.size(); ++i) compare(slice.field_of_view[i], sent.field_of_view[i]);
  return largest;
}

}  // namespace

TEST_CASE("session: 1,000 slices arrive in order and equal to what was sent, and the books close") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1000));
  Inbox inbox;
  auto session = open_session(loopback.port());
  CHECK(session->info().serial == "LOOP-1");
  const auto before = std::chrono::steady_clock::now();
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  const auto after = std::chrono::steady_clock::now();

  const auto slices = inbox.slices();
  REQUIRE(slices.size() == 1000);
  double largest = 0;
  std::size_t not_ok = 0;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    REQUIRE(slices[i]->slice.id == i);
    REQUIRE(slices[i]->arrival >= before);
    REQUIRE(slices[i]->arrival <= after);
    largest = std::max(largest, deviation_mm(*slices[i]));
    not_ok += slices[i]->pose_status != device::PoseStatus::ok ? 1 : 0;
  }
  MESSAGE("largest deviation " << largest << " mm");
  CHECK(largest < 1e-9);
  CHECK(not_ok == 100);  // poses that are not ok stay in and say so
  const auto ledger = session->ledger();
  check_closed(ledger);
  CHECK(ledger.delivered == 1000);
  CHECK(ledger.made == 1000);
  CHECK(inbox.events().size() == 1);
}

TEST_CASE("session: a paced device delivers at its rate without any loss") {
  auto options = loopback_options();
  options.rate_hz = 200;
  device_sim::LoopbackDevice loopback(options, numbered_slices(60));
  Inbox inbox;
  auto session = open_session(loopback.port());
  REQUIRE(session->start({}, inbox.callbacks()));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  check_closed(session->ledger());
  CHECK(session->ledger().made == 60);
  CHECK(session->ledger().transport_lost == 0);
}

TEST_CASE("session: stop inside a callback returns at once and no callback follows") {
  for (const std::uint64_t last : {0u, 1u, 37u}) {
    device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(200));
    auto session = open_session(loopback.port());
    std::atomic<int> calls = 0, events = 0;
    std::promise<void> stopped;
    REQUIRE(session->start(kLossless, {[&](auto slice) {
                                         ++calls;
                                         if (slice->slice.id != last) return;
                                         session->stop();
                                         session->stop();
                                         CHECK(session->ledger().delivered == last + 1);
                                         const auto again = session->start(kLossless, {});
                                         CHECK(again.error().code == ErrorCode::wrong_state);
                                         stopped.set_value();
                                       },
                                       [&](const device::Event&) { ++events; }}));
    stopped.get_future().wait();
    session->stop();
    CHECK(calls == static_cast<int>(last) + 1);
    CHECK(events == 0);
    check_closed(session->ledger());
    CHECK(loopback.stats().state == static_cast<std::uint16_t>(protocol::DeviceState::idle));
  }
}

TEST_CASE("session: after stop inside a callback it can be started again from outside without stopping first") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(400));
  Inbox inbox;
  auto session = open_session(loopback.port());
  std::promise<void> stopped;
  REQUIRE(session->start(kLossless, {[&](auto slice) {
                                       if (slice->slice.id != 5) return;
                                       session->stop();
                                       stopped.set_value();
                                     },
                                     {}}));
  stopped.get_future().wait();
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(50));
  session->stop();
  CHECK(inbox.slices().front()->slice.id == 0);  // a new session counts from 0
  check_closed(session->ledger());
}

TEST_CASE("session: a callback that throws becomes an event and the stream goes on") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(50));
  Inbox inbox;
  auto session = open_session(loopback.port());
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](auto slice) {
    const auto id = slice->slice.id;
    inbox.add(std::move(slice));
    if (id % 10 == 3) throw std::runtime_error("slice " + std::to_string(id));
    if (id == 20) throw 42;
  };
  callbacks.on_event = [&](const device::Event& event) {
    inbox.add(event);
    throw std::runtime_error("and the event callback, too");
  };
  REQUIRE(session->start(kLossless, callbacks));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  CHECK(inbox.slices().size() == 50);
  // 6 of slices; the throw of the end's event is told as well, the throws of those tellings are not.
  const auto threw = inbox.count(EventKind::callback_threw);
  CHECK((threw == 6 || threw == 7));
  CHECK(inbox.events().front().message.find("slice 3") != std::string::npos);
  check_closed(session->ledger());
}

TEST_CASE("session: a slow callback never holds a live device back, what it misses is counted and told once") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  Inbox inbox;
  auto session = open_session(loopback.port());
  std::promise<void> release;
  auto gate = release.get_future().share();
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](auto slice) {
    inbox.add(std::move(slice));
    gate.wait();
  };
  REQUIRE(session->start({StreamMode::live, 8}, callbacks));
  REQUIRE(inbox.wait_for_slices(1));
  while (session->ledger().host_dropped < 500) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(inbox.slices().size() == 1);  // the link ran on while the callback slept
  release.set_value();
  REQUIRE(inbox.wait_for(EventKind::slices_dropped));
  REQUIRE(inbox.wait_for_slices(2));
  session->stop();
  const auto slices = inbox.slices();
  CHECK(slices[1]->slice.id > 500);  // the newest are kept
  check_closed(session->ledger());
  MESSAGE("device dropped " << session->ledger().device_dropped << ", host dropped " << session->ledger().host_dropped);
}

TEST_CASE("session: in lossless mode a slow callback holds an unpaced device back and nothing is lost") {
  device_sim::LoopbackDevice loopback(loopback_options(3), numbered_slices(120));
  Inbox inbox;
  auto session = open_session(loopback.port());
  auto callbacks = inbox.callbacks();
  callbacks.on_slice = [&](auto slice) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    inbox.add(std::move(slice));
  };
  REQUIRE(session->start({StreamMode::lossless, 2}, callbacks));
  REQUIRE(inbox.wait_for(EventKind::end_of_data));
  session->stop();
  CHECK(inbox.slices().size() == 120);
  check_closed(session->ledger());
}

TEST_CASE("session: a paced device that cannot hold a lossless stream reports a fault") {
  auto options = loopback_options(2);
  options.rate_hz = 500;
  device_sim::LoopbackDevice loopback(options, numbered_slices(1u << 30));
  Inbox inbox;
  auto session = open_session(loopback.port());
  auto callbacks = inbox.callbacks();
  std::promise<void> release;
  auto gate = release.get_future().share();
  callbacks.on_slice = [&](auto slice) {
    inbox.add(std::move(slice));
    gate.wait();
  };
  REQUIRE(session->start({StreamMode::lossless, 1}, callbacks));
  while (loopback.stats().fault == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  release.set_value();
  REQUIRE(inbox.wait_for(EventKind::device_fault));
  session->stop();
  CHECK(inbox.count(EventKind::device_fault) == 1);
  check_closed(session->ledger());
}

TEST_CASE("session: a stop from outside waits for the callback that runs, and none runs afterwards") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  auto session = open_session(loopback.port());
  for (int round = 0; round < 20; ++round) {
    std::atomic<bool> inside = false, ended = false, late = false;
    std::promise<void> first;
    std::atomic<bool> told = false;
    REQUIRE(session->start({}, {[&](auto) {
                                  inside = true;
                                  if (!told.exchange(true)) first.set_value();
                                  std::this_thread::sleep_for(std::chrono::milliseconds(2));
                                  if (ended) late = true;
                                  inside = false;
                                },
                                {}}));
    first.get_future().wait();
    session->stop();
    ended = true;
    CHECK_FALSE(inside);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    CHECK_FALSE(late);
    check_closed(session->ledger());
  }
}

TEST_CASE("session: unplugged, it says so exactly once, keeps what came, and stops at once") {
  auto options = loopback_options();
  options.rate_hz = 500;
  device_sim::LoopbackDevice loopback(options, numbered_slices(1u << 30));
  Inbox inbox;
  auto session = open_session(loopback.port());
  REQUIRE(session->start({}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(20));
  loopback.unplug();
  REQUIRE(inbox.wait_for(EventKind::disconnected));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // a beat or more
  CHECK(inbox.count(EventKind::disconnected) == 1);
  CHECK(inbox.events().back().kind == EventKind::disconnected);
  const auto before = std::chrono::steady_clock::now();
  session->stop();
  MESSAGE("stop took " << std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count()
                       << " ms");
  check_closed(session->ledger());
  CHECK(session->ledger().delivered == inbox.slices().size());
  const auto again = session->start({}, inbox.callbacks());
  REQUIRE_FALSE(again);
  CHECK(again.error().code == ErrorCode::transport_closed);
  const auto reopened = device::Session::open(std::make_unique<device::LoopbackTransport>(loopback.port()));
  REQUIRE_FALSE(reopened);
  CHECK(reopened.error().code == ErrorCode::transport_closed);
}

TEST_CASE("session: unplugged and stopped at the same moment, at most one word of it") {
  for (int round = 0; round < 30; ++round) {
    device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
    Inbox inbox;
    auto session = open_session(loopback.port());
    REQUIRE(session->start({}, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(1 + static_cast<std::size_t>(round)));
    std::jthread puller([&] { loopback.unplug(); });
    session->stop();
    CHECK(inbox.count(EventKind::disconnected) <= 1);
  }
}

TEST_CASE("session: opened and closed 200 times, every run begins with record 0 and loses nothing") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  for (int round = 0; round < 200; ++round) {
    Inbox inbox;
    auto session = open_session(loopback.port());
    REQUIRE(session->start(kLossless, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(2));
    if (round % 2 == 0) session->stop();  // else the destructor does
    const auto slices = inbox.slices();
    REQUIRE(slices[0]->slice.id == 0);
    REQUIRE(slices[1]->slice.id == 1);
    if (round % 2 == 0) REQUIRE(session->ledger().closed);
    if (round % 2 == 0) REQUIRE(session->ledger().transport_lost == 0);
  }
}

TEST_CASE("session: a host that died in the middle of a stream costs the next one nothing") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  // A START without an end, as a host leaves behind that was killed.
  std::array<std::byte, protocol::kMaxRequestLen> request{}, reply{};
  const protocol::StartRequest start{0xDEAD, protocol::kSliceStream, 0, 1, 0};
  const auto len = protocol::encode_request(protocol::Command::start, 1, protocol::bytes_of(start), request);
  REQUIRE(loopback.port().control(std::span(request).first(len), reply).status == protocol::PortStatus::ok);
  while (loopback.stats().next_seq < 5) std::this_thread::yield();

  Inbox inbox;
  auto session = open_session(loopback.port());
  REQUIRE(session->start(kLossless, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(10));
  session->stop();
  CHECK(inbox.slices().front()->slice.id == 0);
  CHECK(session->ledger().foreign == 0);
  check_closed(session->ledger());
}

TEST_CASE("session: a second program that stops the device is noticed") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  Inbox inbox;
  auto session = open_session(loopback.port());
  REQUIRE(session->start({}, inbox.callbacks()));
  REQUIRE(inbox.wait_for_slices(1));
  auto other = open_session(loopback.port());  // its open() sends STOP
  REQUIRE(inbox.wait_for(EventKind::device_fault));
  session->stop();
  check_closed(session->ledger());
}

TEST_CASE("session: many threads may stop at once and ask for the books meanwhile") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  auto session = open_session(loopback.port());
  for (int round = 0; round < 10; ++round) {
    Inbox inbox;
    REQUIRE(session->start({}, inbox.callbacks()));
    REQUIRE(inbox.wait_for_slices(3));
    {
      std::vector<std::jthread> stoppers;
      for (int i = 0; i < 4; ++i) {
        stoppers.emplace_back([&] {
          (void)session->ledger();
          session->stop();
          (void)session->ledger();
        });
      }
    }
    check_closed(session->ledger());
  }
}

TEST_CASE("session: start is refused while it runs and with an empty queue") {
  device_sim::LoopbackDevice loopback(loopback_options(), numbered_slices(1u << 30));
  auto session = open_session(loopback.port());
  CHECK(session->start({StreamMode::live, 0}, {}).error().code == ErrorCode::invalid_argument);
  REQUIRE(session->start({}, {}));  // callbacks may be empty
  CHECK(session->start({}, {}).error().code == ErrorCode::wrong_state);
  session->stop();
  session->stop();
  check_closed(session->ledger());
}
