// Which detail a live scan draws, from times that are given: no clock is read.
#include "host/scan/pace.h"

#include <doctest/doctest.h>

#include <chrono>

using namespace sonoloft;
using namespace std::chrono_literals;

namespace {

/// Slices at a fixed distance in time; a full mesh takes `full`, a coarse one a quarter of that, a draft a quarter
/// again.
struct Sweep {
  Pace pace;
  Pace::Clock::time_point now;

  Detail slice(Pace::Clock::duration gap, Pace::Clock::duration full) {
    pace.slice_arrived(now += gap);
    const Detail detail = pace.next();
    pace.took(detail, detail == Detail::full ? full : detail == Detail::coarse ? full / 4 : full / 16);
    return detail;
  }
  int coarse_of(int slices, Pace::Clock::duration gap, Pace::Clock::duration full) {
    int coarse = 0;
    for (int i = 0; i < slices; ++i) coarse += slice(gap, full) == Detail::coarse;
    return coarse;
  }
};

}  // namespace

TEST_CASE("pace: full detail as long as it keeps up with the slices") {
  Sweep sweep;
  CHECK(sweep.coarse_of(50, 100ms, 90ms) == 0);
}

TEST_CASE("pace: coarse detail after a few slices when it does not, and full again when slices come slower") {
  Sweep sweep;
  CHECK(sweep.coarse_of(50, 33ms, 100ms) >= 48);
  CHECK(sweep.coarse_of(50, 150ms, 100ms) <= 6);
}

TEST_CASE("pace: a draft where coarse detail does not keep up either, and coarse detail again when it does") {
  Sweep sweep;
  sweep.coarse_of(10, 33ms, 400ms);
  for (int i = 0; i < 20; ++i) CHECK(sweep.slice(33ms, 400ms) == Detail::draft);
  sweep.coarse_of(10, 33ms, 100ms);
  for (int i = 0; i < 20; ++i) CHECK(sweep.slice(33ms, 100ms) == Detail::coarse);
  sweep.coarse_of(10, 33ms, 10s);
  CHECK(sweep.slice(33ms, 10s) == Detail::draft);
}

TEST_CASE("pace: one slow mesh, and one pause of the hand, change nothing") {
  Sweep sweep;
  sweep.coarse_of(20, 100ms, 50ms);
  CHECK(sweep.slice(100ms, 140ms) == Detail::full);
  CHECK(sweep.slice(100ms, 50ms) == Detail::full);
  sweep.coarse_of(20, 33ms, 100ms);
  CHECK(sweep.slice(20s, 100ms) == Detail::coarse);
  CHECK(sweep.slice(33ms, 100ms) == Detail::coarse);
}

TEST_CASE("pace: a pause is what lasts longer than two slices are apart") {
  Sweep sweep;
  sweep.coarse_of(20, 33ms, 100ms);
  CHECK(sweep.pace.patience() == 66ms);
}

TEST_CASE("pace: nothing is known before the second slice") {
  Pace pace;
  CHECK(pace.next() == Detail::full);
  pace.slice_arrived(Pace::Clock::time_point{});
  pace.took(Detail::full, 10s);
  CHECK(pace.next() == Detail::full);
}
