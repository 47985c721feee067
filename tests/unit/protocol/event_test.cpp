#include "protocol/event.h"

#include <doctest/doctest.h>

#include <vector>

#include "protocol/command.h"

using namespace sonoloft::protocol;

namespace {

std::vector<std::byte> sealed() {
  const EventMessage event = seal_event({0, static_cast<std::uint16_t>(EventKind::button), 2, 1, 77, 123456789, 5, 0});
  const auto bytes = bytes_of(event);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

TEST_CASE("event: what was sealed is read, and a later version's longer one, too") {
  auto bytes = sealed();
  for (int round = 0; round < 2; ++round) {
    const auto event = parse_event(bytes);
    REQUIRE(event);
    CHECK(event->number == 2);
    CHECK(event->session_id == 77);
    CHECK(event->t_device_ns == 123456789);
    CHECK(event->seq == 5);
    bytes.push_back(std::byte{1});
  }
}

TEST_CASE("event: one that was cut, or altered in any bit, is none") {
  const auto bytes = sealed();
  for (std::size_t len = 0; len < bytes.size(); ++len) CHECK_FALSE(parse_event(std::span(bytes).first(len)));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    auto altered = bytes;
    altered[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    CHECK_FALSE(parse_event(altered));
  }
}
