#include "device_sim/probe/random.h"

#include <doctest/doctest.h>

using sonoloft::device_sim::Random;

TEST_CASE("random: the numbers of a seed never change") {
  Random bits(42), other_stream(42, 1);
  CHECK(bits.bits() == 0x6310BF04D8207F46u);
  CHECK(bits.bits() == 0xEBDB7216A4FFED50u);
  CHECK(other_stream.bits() == 0x7F801A88CDE220E2u);
}

TEST_CASE("random: normal numbers have mean 0, variance 1 and the tails of a bell") {
  Random random(7);
  constexpr int kCount = 200'000;
  double sum = 0, squares = 0;
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    beyond_two += x > 2 || x < -2;
  }
  CHECK(sum / kCount == doctest::Approx(0).epsilon(0.01));
  CHECK(squares / kCount == doctest::Approx(1).epsilon(0.01));
  CHECK(beyond_two / double{kCount} == doctest::Approx(0.0455).epsilon(0.05));
}
