#include "host/device/ledger.h"

#include <doctest/doctest.h>

using sonoloft::device::Books;
using sonoloft::device::Ledger;
using sonoloft::protocol::StatsReply;

namespace {

void receive_and_deliver(Books& books, std::uint64_t seq, std::uint32_t dropped) {
  REQUIRE(books.receive(seq, dropped));
  books.deliver();
}

}  // namespace

TEST_CASE("ledger: gaps are the device's drops as far as it says so, the rest was lost on the way") {
  Books books;
  receive_and_deliver(books, 0, 0);
  receive_and_deliver(books, 4, 2);  // 1..3 missing, 2 dropped by the device
  CHECK(books.ledger().transport_lost == 1);
  CHECK(books.ledger().device_dropped == 2);
  books.receive_crc_bad();
  books.receive_malformed();
  CHECK(books.seen() == 7);
  receive_and_deliver(books, 7, 2);
  CHECK(books.ledger().transport_lost == 1);
  books.close(StatsReply{1, 0, 0, 10, 6, 4, 0, 0, 0});
  const Ledger ledger = books.ledger();
  CHECK(ledger.made == 10);
  CHECK(ledger.delivered == 3);
  CHECK(ledger.device_dropped == 4);
  CHECK(ledger.transport_lost == 1);
  CHECK(ledger.closed);
}

TEST_CASE("ledger: records seen before are foreign and change nothing else") {
  Books books;
  receive_and_deliver(books, 0, 0);
  receive_and_deliver(books, 1, 0);
  const Ledger before = books.ledger();
  CHECK_FALSE(books.receive(1, 0));
  CHECK_FALSE(books.receive(0, 5));
  Ledger after = books.ledger();
  CHECK(after.foreign == 2);
  after.foreign = 0;
  CHECK(after == before);
}

TEST_CASE("ledger: with the device gone it closes over what was seen") {
  Books books;
  receive_and_deliver(books, 3, 1);
  books.receive_crc_bad();
  books.close(std::nullopt);
  const Ledger ledger = books.ledger();
  CHECK(ledger.made == 5);
  CHECK(ledger.transport_lost == 2);
  CHECK(ledger.closed);
}

TEST_CASE("ledger: books that contradict the device do not close") {
  const auto closes = [](const StatsReply& stats, int noise) {
    Books books;
    receive_and_deliver(books, 0, 0);
    receive_and_deliver(books, 1, 0);
    for (int i = 0; i < noise; ++i) books.receive_malformed();
    books.close(stats);
    return books.ledger().closed;
  };
  CHECK(closes({1, 0, 0, 2, 2, 0, 0, 0, 0}, 0));
  CHECK(closes({1, 0, 0, 3, 3, 0, 0, 0, 0}, 1));
  CHECK_FALSE(closes({1, 0, 0, 2, 2, 0, 0, 0, 0}, 1));  // more came than was made
  CHECK_FALSE(closes({1, 0, 0, 1, 1, 0, 0, 0, 0}, 0));  // it made fewer than it numbered
  CHECK_FALSE(closes({1, 0, 0, 5, 2, 0, 0, 0, 0}, 0));  // its own sum is wrong
  Books undelivered;
  REQUIRE(undelivered.receive(0, 0));
  undelivered.close(StatsReply{1, 0, 0, 1, 1, 0, 0, 0, 0});
  CHECK_FALSE(undelivered.ledger().closed);
}
