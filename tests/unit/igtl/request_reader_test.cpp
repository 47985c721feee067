#include "host/igtl/wire/request_reader.h"

#include <doctest/doctest.h>

#include <random>

#include "tests/unit/igtl/igtl_client.h"

using namespace sonoloft;
using namespace sonoloft::test;
using igtl::RequestReader;

namespace {

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// A header that states any size, with nothing behind it.
Bytes claiming(std::uint64_t body_len, int version = 1) {
  Bytes bytes = message("IMAGE", "camera", {}, 1);
  Bytes fields;
  append_big_endian(fields, body_len, 8);
  std::copy(fields.begin(), fields.end(), bytes.begin() + 42);
  bytes[1] = static_cast<std::byte>(version);
  return bytes;
}

}  // namespace

TEST_CASE("requests: they come out whole and in order, however the bytes are cut") {
  const Bytes content(36, std::byte{7});
  const Bytes sent = joined({message("GET_POLYDATA", "liver"), message("STT_TDATA", "", content),
                             message("GET_STATUS", "x", {}, 2), message("STT_TDATA", "", content, 2)});
  for (const std::size_t step : {std::size_t{1}, std::size_t{7}, std::size_t{58}, sent.size()}) {
    CAPTURE(step);
    RequestReader reader;
    std::vector<igtl::Request> got;
    for (std::size_t at = 0; at < sent.size(); at += step) {
      const auto some = reader.take(std::span(sent).subspan(at, std::min(step, sent.size() - at)));
      REQUIRE(some);
      got.insert(got.end(), some->begin(), some->end());
    }
    REQUIRE(got.size() == 4);
    for (const auto& request : got) CHECK(request.sound);
    CHECK(got[0].type == "GET_POLYDATA");
    CHECK(got[0].device == "liver");
    CHECK(got[0].body.empty());
    CHECK(got[1].body == content);
    CHECK(got[1].version == 1);
    CHECK(got[2].type == "GET_STATUS");
    CHECK(got[2].version == 2);
    CHECK(got[2].body.empty());
    CHECK(got[3].body == content);
  }
}

TEST_CASE("requests: a wrong check sum spoils one message and none after it") {
  Bytes bad = message("STT_TDATA", "", Bytes(36));
  bad.back() ^= std::byte{1};
  RequestReader reader;
  const auto got = reader.take(joined({bad, message("GET_STATUS", "")}));
  REQUIRE(got);
  REQUIRE(got->size() == 2);
  CHECK(!(*got)[0].sound);
  CHECK((*got)[0].body.empty());
  CHECK((*got)[1].sound);
}

TEST_CASE("requests: sizes of an extended header that do not fit spoil the message") {
  for (const std::size_t field : {0u, 2u, 4u}) {
    Bytes bad = message("STT_TDATA", "", Bytes(36), 2);
    bad[58 + field] = std::byte{0x7F};
    Bytes sum;
    append_big_endian(sum, ecma_crc(std::span(bad).subspan(58)), 8);
    std::copy(sum.begin(), sum.end(), bad.begin() + 50);
    RequestReader reader;
    const auto got = reader.take(bad);
    REQUIRE(got);
    REQUIRE(got->size() == 1);
    CHECK(!got->front().sound);
  }
}

TEST_CASE("requests: a long message is passed over without being kept") {
  RequestReader reader;
  const std::uint64_t long_len = 100'000'000;
  const auto first = reader.take(claiming(long_len));
  REQUIRE(first);
  REQUIRE(first->size() == 1);
  CHECK(!first->front().sound);
  const Bytes part(1'000'000);
  for (int i = 0; i < 100; ++i) {
    const auto none = reader.take(part);
    REQUIRE(none);
    CHECK(none->empty());
  }
  const auto next = reader.take(message("GET_STATUS", ""));
  REQUIRE(next);
  REQUIRE(next->size() == 1);
  CHECK(next->front().type == "GET_STATUS");
}

TEST_CASE("requests: what cannot be OpenIGTLink is told from what can") {
  for (const std::uint64_t size : {std::uint64_t{1} << 31, std::uint64_t{1} << 63, ~std::uint64_t{0}}) {
    RequestReader reader;
    CHECK(!reader.take(claiming(size)));
  }
  const std::string http = "GET / HTTP/1.1\r\nHost: localhost:18944\r\nUser-Agent: a browser\r\nAccept: */*\r\n\r\n";
  RequestReader of_browser, of_zeros;
  CHECK(!of_browser.take(std::as_bytes(std::span(http))));
  CHECK(!of_zeros.take(Bytes(58)));
  Bytes no_text = message("GET_STATUS", "");
  no_text[5] = std::byte{0x07};
  RequestReader of_bell;
  CHECK(!of_bell.take(no_text));
}

TEST_CASE("requests: a later version's messages are understood by what is the same in them") {
  RequestReader reader;
  const auto got = reader.take(message("GET_POLYDATA", "", {}, 3));
  REQUIRE(got);
  REQUIRE(got->size() == 1);
  CHECK(got->front().sound);
  CHECK(got->front().version == 3);
}

TEST_CASE("requests: flipped bits in sound messages never do more than spoil them") {
  std::mt19937 random(5);
  const Bytes sound = joined({message("STT_TDATA", "", Bytes(36), 2), message("GET_POLYDATA", "liver")});
  int sane = 0, insane = 0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes = sound;
    for (int flips = 0; flips < 3; ++flips)
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << random() % 8);
    RequestReader reader;
    const auto got = reader.take(bytes);
    ++(got ? sane : insane);
    if (got) CHECK(got->size() <= 2);
  }
  MESSAGE(sane, " taken, ", insane, " not");
  CHECK(sane > 1000);
  CHECK(insane > 1000);
}
