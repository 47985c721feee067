#include <doctest/doctest.h>

#include <deque>
#include <random>

#include "device_sim/firmware/record_ring.h"
#include "tests/support/wire/wire_slices.h"

using sonoloft::device_sim::RecordRing;
using sonoloft::test::AlignedBytes;

TEST_CASE("ring: it behaves as a queue with a limit, whatever is done to it") {
  AlignedBytes memory(5 * 128 + 100);
  RecordRing ring(memory.bytes(), 128);
  CHECK(ring.capacity() == 5);
  std::deque<int> model;
  std::mt19937 random(3);
  int next = 0;
  for (int round = 0; round < 5000; ++round) {
    if (random() % 200 == 0) {
      ring.clear();
      model.clear();
    } else if (random() % 2 == 0 && !ring.full()) {
      ring.free_slot()[0] = static_cast<std::byte>(next % 251);
      ring.free_slot()[127] = static_cast<std::byte>(next % 241);
      ring.push();
      model.push_back(next++);
    } else if (!ring.empty()) {
      ring.pop();
      model.pop_front();
    }
    REQUIRE(ring.used() == model.size());
    REQUIRE(ring.empty() == model.empty());
    REQUIRE(ring.full() == (model.size() == 5));
    if (model.empty()) continue;
    REQUIRE(ring.oldest()[0] == static_cast<std::byte>(model.front() % 251));
    REQUIRE(ring.oldest()[127] == static_cast<std::byte>(model.front() % 241));
    REQUIRE(reinterpret_cast<std::uintptr_t>(ring.oldest().data()) % 64 == 0);
  }
}
