// Which detail a live scan draws, from times and samples that are given: no clock is read.
#include "host/scan/pace.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>

using namespace sonoloft;
using namespace std::chrono_literals;

namespace {

/// Slices that each change so many of the 400,000 samples that a full mesh has. An update takes a fifth of a
/// microsecond for each sample that it takes, and 4 ms besides.
struct Sweep {
  Pace pace;
  Pace::Clock::time_point now;
  Pace::SamplesDue due{};
  Detail shown = Detail::full;

  Detail slice(Pace::Clock::duration gap, std::size_t samples) {
    pace.slice_arrived(now += gap);
    for (std::size_t d = 0; d < kDetails; ++d)
      due[d] = std::min<std::size_t>(due[d] + (samples >> 2 * d), 400'000 >> 2 * d);
    shown = pace.next(shown, due);
    std::size_t& taken = due[static_cast<std::size_t>(shown)];
    pace.took(taken, 2 + 200e-6 * static_cast<double>(taken), 2);
    taken = 0;
    return shown;
  }
  std::array<int, kDetails> slices(int count, Pace::Clock::duration gap, std::size_t samples) {
    std::array<int, kDetails> drawn{};
    for (int i = 0; i < count; ++i) ++drawn[static_cast<std::size_t>(slice(gap, samples))];
    return drawn;
  }
};

}  // namespace

TEST_CASE("pace: full detail as long as it keeps up with the slices") {
  Sweep sweep;
  CHECK(sweep.slices(50, 100ms, 400'000)[0] == 50);
}

TEST_CASE("pace: coarse detail for the very slice that has too much to do, however little the ones before had") {
  Sweep sweep;
  CHECK(sweep.slices(20, 33ms, 50'000)[0] == 20);
  CHECK(sweep.slice(33ms, 250'000) == Detail::coarse);
}

TEST_CASE("pace: full detail again once slices have less to do for a while, or come slower") {
  Sweep less;
  less.slices(20, 33ms, 250'000);
  CHECK(less.shown == Detail::coarse);
  CHECK(less.slice(33ms, 20'000) == Detail::coarse);
  less.slices(9, 50ms, 20'000);
  CHECK(less.shown == Detail::full);
  Sweep slower;
  slower.slices(20, 33ms, 250'000);
  slower.slices(9, 100ms, 250'000);
  CHECK(slower.shown == Detail::full);
}

TEST_CASE("pace: a detail that takes more than two slices' time to catch up waits for a pause") {
  Sweep sweep;
  sweep.slices(20, 33ms, 250'000);
  CHECK(sweep.slices(50, 33ms, 20'000)[0] == 0);  // 400,000 samples would be due, 84 ms
  CHECK(sweep.shown == Detail::coarse);
}

TEST_CASE("pace: a draft where coarse detail does not keep up either, and coarse detail again when it does") {
  Sweep sweep;
  sweep.slices(10, 12ms, 400'000);
  CHECK(sweep.shown == Detail::draft);
  CHECK(sweep.slices(20, 12ms, 400'000)[2] == 20);
  sweep.slices(10, 12ms, 80'000);
  CHECK(sweep.slices(20, 12ms, 80'000)[1] == 20);
}

TEST_CASE("pace: where nothing keeps up, what takes the least time") {
  Sweep sweep;
  CHECK(sweep.slices(20, 1ms, 400'000)[2] >= 18);
}

TEST_CASE("pace: one pause of the hand changes nothing") {
  Sweep sweep;
  sweep.slices(20, 33ms, 250'000);
  CHECK(sweep.slice(20s, 250'000) == Detail::coarse);
  CHECK(sweep.slice(33ms, 250'000) == Detail::coarse);
}

TEST_CASE("pace: a pause is what lasts longer than two slices are apart") {
  Sweep sweep;
  sweep.slices(20, 33ms, 250'000);
  CHECK(sweep.pace.patience() == 66ms);
}

TEST_CASE("pace: nothing is known before the second slice") {
  Pace pace;
  CHECK(pace.next(Detail::full, {}) == Detail::full);
  pace.slice_arrived(Pace::Clock::time_point{});
  pace.took(400'000, 10'000, 100);
  CHECK(pace.next(Detail::full, {400'000, 100'000, 25'000}) == Detail::full);
}
