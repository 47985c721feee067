#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "host/apps/tool/common_options.h"
#include "host/apps/tool/figures.h"
#include "host/apps/tool/interrupt.h"
#include "host/apps/tool/phantom/simulated_probe_options.h"
#include "host/apps/tool/verbs/verbs.h"
#include "host/device/loopback/loopback_transport.h"
#include "host/device/session.h"
#include "host/device/usb/usb_transport.h"

namespace sonoloft::tool {
namespace {

struct StatsOptions {
  std::string serial;
  bool simulated = false;
  SimulatedProbeOptions probe;
  double seconds = 5;
};

/// From the middle of the acquisition to the transfer's end and to the callback, on the host's clock. Threads: any.
class Latencies {
 public:
  void add(const device::DeliveredSlice& slice) {
    if (!slice.host_time) return;
    const auto called = std::chrono::steady_clock::now();
    const std::lock_guard lock(mutex_);
    arrival_ms_.push_back(ms(slice.arrival - slice.host_time->time));
    callback_ms_.push_back(ms(called - slice.arrival));
  }
  void print() const {
    const std::lock_guard lock(mutex_);
    const Percentiles arrival = percentiles(arrival_ms_), callback = percentiles(callback_ms_);
    std::printf("image to arrival     p50 %.3f ms, p95 %.3f ms, max %.3f ms\n", arrival.p50, arrival.p95, arrival.max);
    std::printf("arrival to callback  p50 %.3f ms, p95 %.3f ms, max %.3f ms\n", callback.p50, callback.p95,
                callback.max);
  }

 private:
  static double ms(std::chrono::nanoseconds time) { return static_cast<double>(time.count()) * 1e-6; }

  mutable std::mutex mutex_;
  std::vector<double> arrival_ms_, callback_ms_;
};

void print(const device::Statistics& s, double seconds) {
  const device::Ledger& l = s.ledger;
  const auto line = [](const char* what, std::uint64_t count) { std::printf("%-20s %llu\n", what, 0ull + count); };
  line("made", l.made);
  line("  delivered", l.delivered);
  line("  host_dropped", l.host_dropped);
  line("  crc_bad", l.crc_bad);
  line("  malformed", l.malformed);
  line("  transport_lost", l.transport_lost);
  line("  device_dropped", l.device_dropped);
  line("foreign", l.foreign);
  std::printf("%-20s %s\n", "books", l.closed ? "closed: made is the sum of the six" : "not closed");
  for (std::size_t i = 1; i < s.rejected.size(); ++i) {
    if (s.rejected[i] != 0) line(protocol::name(static_cast<protocol::Reject>(i)), s.rejected[i]);
  }
  if (s.events_lost != 0) line("events lost", s.events_lost);
  std::printf("%-20s %.1f a second\n", "slices", static_cast<double>(l.delivered) / seconds);
  if (!s.clock) return;
  std::printf("device's clock       drift %.2f ppm, round trip %.3f ms, mapped to within %.3f ms\n", s.clock->drift_ppm,
              static_cast<double>(s.clock->round_trip.count()) * 1e-6,
              static_cast<double>(s.clock->uncertainty.count()) * 1e-6);
}

Result<void> watch(std::unique_ptr<device::Transport> transport, double seconds) {
  const auto session = device::Session::open(std::move(transport));
  if (!session) return tl::unexpected<Error>(session.error());
  std::cout << "probe " << (*session)->info().serial << ", firmware " << (*session)->info().firmware_version
            << std::endl;
  Latencies latencies;
  std::mutex ended;
  bool over = false;
  device::Callbacks callbacks;
  callbacks.on_slice = [&](std::shared_ptr<const device::DeliveredSlice> slice) { latencies.add(*slice); };
  callbacks.on_event = [&](const device::Event& event) {
    std::cout << event.message << std::endl;
    const std::lock_guard lock(ended);
    over |= event.kind == device::EventKind::disconnected || event.kind == device::EventKind::end_of_data;
  };
  note_interrupts();
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const auto finished = [&] {
    const std::lock_guard lock(ended);
    return over || interrupted() || elapsed() >= seconds;
  };
  if (auto started = (*session)->start({}, callbacks); !started) return started;
  while (!finished()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const double took = elapsed();
  (*session)->stop();
  print((*session)->statistics(), took);
  latencies.print();
  return {};
}

Result<void> watch_simulated(const StatsOptions& options) {
  const auto body = load_body(options.probe.phantom, options.probe.data);
  if (!body) return tl::unexpected<Error>(body.error());
  const auto probe = SimulatedScan::make(*body, options.probe.plan);
  if (!probe) return tl::unexpected<Error>(probe.error());
  return watch(std::make_unique<device::LoopbackTransport>((*probe)->port()), options.seconds);
}

Result<void> run_stats(const StatsOptions& options) {
  if (options.simulated) return watch_simulated(options);
  auto transport = device::UsbTransport::open(options.serial);
  if (!transport) return tl::unexpected<Error>(transport.error());
  return watch(std::move(*transport), options.seconds);
}

}  // namespace

void add_stats(CLI::App& app, Task& task) {
  auto* verb = app.add_subcommand("stats", "Streams from a probe and says what became of every record, and how late");
  auto options = std::make_shared<StatsOptions>();
  auto* simulated = verb->add_flag("--simulated", options->simulated, "From a simulated probe instead of one on USB");
  verb->add_option("--serial", options->serial, "The probe; default: the only one that is plugged in")
      ->excludes(simulated);
  verb->add_option("--seconds", options->seconds, "How long")->check(finite(0.1, 1e5))->capture_default_str();
  add_simulated_probe(*verb, options->probe);
  verb->callback([&task, options] { task = [options] { return run_stats(*options); }; });
}

}  // namespace sonoloft::tool
