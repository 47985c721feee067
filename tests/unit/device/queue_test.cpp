#include <doctest/doctest.h>

#include "host/device/delivery_queue.h"

using namespace sonoloft::device;

namespace {

std::shared_ptr<const DeliveredSlice> slice(std::uint64_t id) {
  auto delivered = std::make_shared<DeliveredSlice>();
  delivered->slice.id = id;
  return delivered;
}

std::uint64_t id_of(const std::optional<DeliveryQueue::Item>& item) {
  REQUIRE(item);
  return std::get<0>(*item)->slice.id;
}

EventKind kind_of(const std::optional<DeliveryQueue::Item>& item) {
  REQUIRE(item);
  return std::get<Event>(*item).kind;
}

}  // namespace

TEST_CASE("queue: items come out in order, slices and events mixed") {
  DeliveryQueue queue(3);
  CHECK_FALSE(queue.push(slice(1)));
  queue.push(Event{EventKind::device_fault, "x"});
  CHECK_FALSE(queue.push(slice(2)));
  CHECK(queue.slices() == 2);
  CHECK(id_of(queue.pop()) == 1);
  CHECK(kind_of(queue.pop()) == EventKind::device_fault);
  CHECK(id_of(queue.pop()) == 2);
  CHECK_FALSE(queue.pop());
  CHECK(queue.empty());
}

TEST_CASE(
    "queue: when it is full the oldest slice gives way, never an event, and that is told once until it is empty") {
  DeliveryQueue queue(2);
  for (int episode = 0; episode < 2; ++episode) {
    queue.push(Event{EventKind::device_fault, "x"});
    CHECK_FALSE(queue.push(slice(1)));
    CHECK_FALSE(queue.push(slice(2)));
    CHECK(queue.push(slice(3)));
    CHECK(queue.push(slice(4)));
    CHECK(queue.slices() == 2);
    CHECK(kind_of(queue.pop()) == EventKind::device_fault);
    // slice 3, the news that came right behind it, slice 4
    CHECK(id_of(queue.pop()) == 3);
    CHECK(kind_of(queue.pop()) == EventKind::slices_dropped);
    CHECK(id_of(queue.pop()) == 4);
    CHECK(queue.empty());
  }
}
