#include <doctest/doctest.h>

#include <filesystem>
#include <iterator>

#include "tests/property/faults/bus.h"
#include "tests/property/faults/witness.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

std::ptrdiff_t entries(const char* folder) {
  return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

}  // namespace

TEST_CASE("faults: plugged in, scanned with and pulled out many times leaves no thread and no file behind") {
  for (const Bus& bus : kBuses) {
    CAPTURE(std::string(bus.name));
    const auto threads = entries("/proc/self/task"), files = entries("/proc/self/fd");
    std::uint64_t delivered = 0, wrong = 0, told = 0, open_books = 0;
    for (int cycle = 0; cycle < bus.plug_cycles; ++cycle) {
      device_sim::LoopbackDevice loopback(loopback_options(2), numbered_small_slices(3));
      auto session = open_session(bus, loopback.port());
      Witness witness(session->calibration());
      REQUIRE(session->start({}, witness.callbacks()));
      if (cycle % 2 == 0) {
        while (witness.delivered == 0) std::this_thread::yield();
      }
      loopback.unplug();
      session->stop();
      delivered += witness.delivered;
      wrong += witness.wrong;
      told += witness.disconnected;
      open_books += !session->ledger().closed;
    }
    CHECK(wrong == 0);
    CHECK(open_books == 0);
    CHECK(delivered >= static_cast<std::uint64_t>(bus.plug_cycles) / 2);
    CHECK(told <= static_cast<std::uint64_t>(bus.plug_cycles));
    CHECK(entries("/proc/self/task") == threads);
    CHECK(entries("/proc/self/fd") == files);
    MESSAGE(std::string(bus.name) << ": " << delivered << " slices delivered, " << told
                                  << " times told that the device went away");
  }
}
