#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "host/device/clock/clock_map.h"
#include "host/device/clock/sync_schedule.h"

using namespace sonoloft::device;

namespace {

constexpr std::int64_t kMs = 1'000'000, kSecond = 1'000'000'000;

/// A device, its bus and the host's clock, all in virtual time.
class VirtualLink {
 public:
  VirtualLink(std::uint64_t device_start, double drift_ppm, std::uint32_t seed)
      : device_start_(device_start), rate_(1 - drift_ppm * 1e-6), random_(seed), schedule_(seed) {}

  std::int64_t now = 1000 * kSecond;  ///< the host's clock

  std::uint64_t device_time(std::int64_t host) const {
    return device_start_ + static_cast<std::uint64_t>(std::llround(static_cast<double>(host - 1000 * kSecond) * rate_));
  }
  void set_device_clock(std::int64_t by) { device_start_ += static_cast<std::uint64_t>(by); }

  /// 0.1 ms and up to 2 ms of jitter either way, and 50 ms more on one way of every hundredth round trip.
  TimeExchange exchange() {
    const bool late = random_() % 100 == 0, on_the_way_out = random_() % 2 == 0;
    TimeExchange e{now, 0, 0};
    now += leg() + (late && on_the_way_out ? 50 * kMs : 0);
    e.device_ns = device_time(now);
    now += leg() + (late && !on_the_way_out ? 50 * kMs : 0);
    e.received_ns = now;
    return e;
  }
  std::vector<TimeExchange> burst() {
    std::vector<TimeExchange> all;
    for (int i = 0; i < SyncSchedule::kBurst; ++i) {
      all.push_back(exchange());
      now += std::chrono::nanoseconds(schedule_.pause_in_burst()).count();
    }
    return all;
  }
  void hurry() { schedule_.begin_anew(); }
  std::int64_t pause() { return std::chrono::nanoseconds(schedule_.pause()).count(); }

 private:
  std::int64_t leg() { return kMs / 10 + static_cast<std::int64_t>(random_() % static_cast<std::uint32_t>(2 * kMs)); }

  std::uint64_t device_start_;
  double rate_;
  std::mt19937 random_;
  SyncSchedule schedule_;
};

std::int64_t host_ns(const HostTime& t) {
  return std::chrono::nanoseconds(t.time.time_since_epoch()).count();
}

/// Maps what a device acquires at 60 Hz for a while, and keeps the clock in step meanwhile.
struct Mapped {
  std::vector<double> errors_ms;  ///< of slices later than 5 s
  std::size_t backwards = 0, outside = 0;
  std::int64_t last = 0;

  void run(VirtualLink& link, ClockMap& map, std::int64_t duration) {
    const std::int64_t start = link.now, period = kSecond / 60;
    if (map.add(link.burst())) link.hurry();
    std::int64_t next_burst = link.now + link.pause(), slice = link.now;
    for (; slice < start + duration; slice += period) {
      while (next_burst < slice) {
        link.now = next_burst;
        if (map.add(link.burst())) link.hurry();
        next_burst = link.now + link.pause();
      }
      const auto mapped = map.at(link.device_time(slice));
      REQUIRE(mapped);
      backwards += host_ns(*mapped) < last;
      last = host_ns(*mapped);
      const std::int64_t error = std::abs(last - slice);
      outside += error > mapped->uncertainty.count();
      if (slice > start + 5 * kSecond) errors_ms.push_back(static_cast<double>(error) / kMs);
    }
    link.now = std::max(link.now, slice);
  }
};

double quantile(std::vector<double>& values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

}  // namespace

TEST_CASE("clock: 300 ppm, 2 ms of jitter and late replies leave less than 0.5 ms after 5 s, over every wrap") {
  // The clock passes its start + 20 s: where a low word of ns or us ends, where signed and unsigned numbers do.
  const std::vector<std::pair<std::string, std::uint64_t>> boundaries{{"0", 0},
                                                                      {"2^32 ns", (1ull << 32)},
                                                                      {"2^32 us", (1ull << 32) * 1000},
                                                                      {"2^53 ns", 1ull << 53},
                                                                      {"2^63 ns", 1ull << 63},
                                                                      {"2^64 ns", 0}};
  std::vector<double> all;
  for (const auto& entry : boundaries) {
    const auto& text = entry.first;
    const std::uint64_t boundary = entry.second;
    CAPTURE(text);
    std::vector<double> errors;
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
      CAPTURE(seed);
      const std::uint64_t start = text == "0" ? 0 : boundary - 20 * kSecond;
      VirtualLink link(start, seed % 2 == 0 ? 300 : -300, seed);
      ClockMap map;
      Mapped mapped;
      mapped.run(link, map, 60 * kSecond);
      CHECK(mapped.backwards == 0);
      CHECK(mapped.outside == 0);
      errors.insert(errors.end(), mapped.errors_ms.begin(), mapped.errors_ms.end());
    }
    CHECK(quantile(errors, 0.99) < 0.5);
    CHECK(errors.back() < 1.0);
    all.insert(all.end(), errors.begin(), errors.end());
  }
  MESSAGE("error after 5 s: median " << quantile(all, 0.5) << " ms, p99 " << quantile(all, 0.99) << " ms, largest "
                                     << all.back() << " ms");
}

TEST_CASE("clock: it says how fast the clocks drift apart") {
  VirtualLink link(77, 300, 4);
  ClockMap map;
  Mapped mapped;
  mapped.run(link, map, 60 * kSecond);
  CHECK(map.drift_ppm() == doctest::Approx(300).epsilon(0.05));
  CHECK(map.round_trip() < std::chrono::milliseconds(2));  // of jitter there are up to 4
}

TEST_CASE("clock: a new line is approached by no more than 1 ms a second") {
  ClockMap map;
  const TimeExchange before{0, 0, 10 * kMs};
  map.add({&before, 1});
  REQUIRE(map.at(0));
  CHECK(host_ns(*map.at(0)) == 5 * kMs);
  const TimeExchange quick{kSecond, static_cast<std::uint64_t>(kSecond), kSecond};  // the first one was 5 ms late
  map.add({&quick, 1});
  std::int64_t last = host_ns(*map.at(static_cast<std::uint64_t>(kSecond)));
  CHECK(last == kSecond + 5 * kMs);
  for (std::int64_t t = kSecond + kMs; t <= 8 * kSecond; t += kMs) {
    const std::int64_t next = host_ns(*map.at(static_cast<std::uint64_t>(t)));
    REQUIRE(std::abs(next - last - kMs) <= kMs / 1000 + std::llround(std::abs(map.drift_ppm())) + 1);
    last = next;
  }
  CHECK(std::abs(last - 8 * kSecond) < kMs);
}

TEST_CASE("clock: times that were mapped late lie on the line of their time") {
  VirtualLink link(0, 300, 5);
  ClockMap map;
  Mapped mapped;
  mapped.run(link, map, 10 * kSecond);
  const std::uint64_t past = link.device_time(link.now - kSecond);
  const auto before = map.at(past);
  map.add(link.burst());
  map.add(link.burst());
  CHECK(map.at(past)->time == before->time);
}

TEST_CASE("clock: a device whose clock was set, forward or back, is followed at once and never runs backwards") {
  for (const std::int64_t by : {3600 * kSecond, -3600 * kSecond, 30 * kMs, -30 * kMs}) {
    CAPTURE(by);
    VirtualLink link(5000 * kSecond, 100, 6);
    ClockMap map;
    Mapped mapped;
    mapped.run(link, map, 10 * kSecond);
    link.set_device_clock(by);
    mapped.outside = 0;
    mapped.errors_ms.clear();
    mapped.run(link, map, 20 * kSecond);
    CHECK(mapped.backwards == 0);
    CHECK(quantile(mapped.errors_ms, 0.99) < 0.5);
  }
}

TEST_CASE("clock: a device time from nowhere moves nothing") {
  VirtualLink link(0, 0, 7);
  ClockMap map;
  CHECK_FALSE(map.at(5));
  Mapped mapped;
  mapped.run(link, map, 10 * kSecond);
  (void)map.at(1ull << 62);
  (void)map.at(1ull << 63);
  (void)map.at(link.device_time(link.now) + (1ull << 63));
  for (const std::int64_t set : {std::int64_t{0}, 3600 * kSecond}) {
    CAPTURE(set);
    link.set_device_clock(set);
    mapped.errors_ms.clear();
    mapped.run(link, map, 20 * kSecond);
    CHECK(mapped.backwards == 0);
    CHECK(quantile(mapped.errors_ms, 0.99) < 0.5);
  }
}
