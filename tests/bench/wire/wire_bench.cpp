// What the wire carries a second and core, from firmware to the session's callback with all checks on, and how late a
// slice is at 60 Hz: over the loopback, and over USB/IP, whose server and TCP are not part of a real probe's way.
// bench_wire
#include <array>
#include <condition_variable>
#include <ctime>
#include <memory>
#include <mutex>

#include "device_sim/port/loopback_device.h"
#include "host/device/loopback/loopback_transport.h"
#include "host/device/session.h"
#include "tests/bench/support/figures.h"
#include "tests/support/wire/wire_slices.h"
#include "tests/usb/usbip/served_transport.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

constexpr std::uint32_t kContours = 20, kPointsEach = 200;  // the usual slice: 32 KB
constexpr std::uint32_t kSlices = 20'000, kPacedSlices = 900;
constexpr double kPacedHz = 60;

std::unique_ptr<device::Transport> connect_loopback(protocol::Port& port, const device_sim::usb::UsbIdentity&) {
  return std::make_unique<device::LoopbackTransport>(port);
}

struct Bus {
  const char* name;
  std::string figure;  ///< the beginning of its figures' names
  decltype(&connect_loopback) connect;
};

const std::array<Bus, 2> kBuses{
    {{"wire", "wire", connect_loopback}, {"wire over USB/IP", "wire_usbip", test::serve_over_usbip}}};

/// The same slice over and over, taken the moment that it is asked for.
device_sim::SliceSource usual_slices(std::uint32_t count) {
  auto owned = std::make_shared<test::OwnedWireSlice>(test::make_wire_slice(1, kContours, kPointsEach));
  (void)owned->view();
  return [owned, left = count]() mutable -> const device_sim::AcquiredSlice* {
    if (left-- == 0) return nullptr;
    owned->slice.time_ns =
        static_cast<std::uint64_t>(std::chrono::nanoseconds(Clock::now().time_since_epoch()).count());
    return &owned->slice;
  };
}

struct Arrivals {
  std::vector<double> callback_ms, whole_way_ms;  ///< since the transfer was complete; since the acquisition
  device::Statistics statistics;
  double cpu_s = 0, wall_s = 0;
};

double ms(std::chrono::nanoseconds time) {
  return static_cast<double>(time.count()) * 1e-6;
}

Arrivals stream(const Bus& bus, std::uint32_t slices, std::optional<double> rate_hz, device::StreamMode mode) {
  device_sim::LoopbackOptions options;
  options.firmware.calibration = {test::kTestCalibrationId, 0, {0.2, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 1, 0}};
  options.rate_hz = rate_hz;
  device_sim::LoopbackDevice device(options, usual_slices(slices));
  const auto session = or_exit(device::Session::open(bus.connect(
      device.port(), {options.firmware.serial.data(), device_sim::record_slot_len(options.firmware.limits)})));

  Arrivals arrivals;
  std::mutex mutex;
  std::condition_variable changed;
  bool over = false;
  device::Callbacks callbacks;
  callbacks.on_slice = [&](std::shared_ptr<const device::DeliveredSlice> slice) {
    const auto now = Clock::now();
    arrivals.callback_ms.push_back(ms(now - slice->arrival));
    arrivals.whole_way_ms.push_back(ms(now - Clock::time_point(slice->slice.time)));
  };
  callbacks.on_event = [&](const device::Event&) {
    const std::lock_guard lock(mutex);
    over = true;
    changed.notify_all();
  };
  const std::clock_t cpu = std::clock();
  const auto start = Clock::now();
  if (const auto started = session->start({mode, 64}, callbacks); !started) stop(started.error());
  std::unique_lock lock(mutex);
  changed.wait(lock, [&] { return over; });
  lock.unlock();
  session->stop();
  arrivals.cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  arrivals.wall_s = ms_since(start) * 1e-3;
  arrivals.statistics = session->statistics();
  return arrivals;
}

void measure_throughput(const Bus& bus) {
  auto slice = test::make_wire_slice(1, kContours, kPointsEach);
  const double record = static_cast<double>(test::make_record(slice.view()).size());
  const Arrivals a = stream(bus, kSlices, std::nullopt, device::StreamMode::lossless);
  const double mb = record * static_cast<double>(a.statistics.ledger.delivered) * 1e-6;
  char words[200];
  std::snprintf(words, sizeof words, "%s: %.0f MB/s a core (goal 40), %.0f MB/s as it ran; %llu slices of %.1f KB%s",
                bus.name, mb / a.cpu_s, mb / a.wall_s, 0ull + a.statistics.ledger.delivered, record * 1e-3,
                a.statistics.ledger.closed ? "" : ", books not closed");
  emit({{"bench", bus.figure}, {"mb_per_s_core", mb / a.cpu_s}, {"mb_per_s", mb / a.wall_s}}, words);
}

void measure_latency(const Bus& bus) {
  const Arrivals a = stream(bus, kPacedSlices, kPacedHz, device::StreamMode::live);
  char words[200];
  std::snprintf(words, sizeof words,
                "%s at %.0f Hz: arrival to callback p50 %.3f, p99 %.3f ms (goal 2); acquisition to callback p50 %.3f, "
                "p99 %.3f ms; %llu of %llu delivered",
                bus.name, kPacedHz, median(a.callback_ms), quantile(a.callback_ms, 0.99), median(a.whole_way_ms),
                quantile(a.whole_way_ms, 0.99), 0ull + a.statistics.ledger.delivered, 0ull + a.statistics.ledger.made);
  emit({{"bench", bus.figure + "_latency"},
        {"callback_p50_ms", median(a.callback_ms)},
        {"callback_p99_ms", quantile(a.callback_ms, 0.99)},
        {"whole_way_p50_ms", median(a.whole_way_ms)},
        {"whole_way_p99_ms", quantile(a.whole_way_ms, 0.99)}},
       words);
}

}  // namespace

int main() {
  for (const Bus& bus : kBuses) {
    measure_throughput(bus);
    measure_latency(bus);
  }
}
