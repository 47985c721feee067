// Clients that are slow, frozen, gone or no clients at all.
#include <doctest/doctest.h>

#include <deque>
#include <random>

#include "tests/unit/igtl/served.h"

using namespace sonoloft;
using namespace sonoloft::test;

TEST_CASE("igtl clients: a frozen one is closed and counted, and the others get their meshes meanwhile") {
  igtl::ServerOptions options;
  options.patience = std::chrono::milliseconds(500);
  const auto server = serve(options);
  server->show(large_update(1));
  IgtlClient frozen(server->port(), 4096), lively(server->port());
  std::uint64_t number = 1;
  while (server->counts().frozen == 0) {
    const auto received = lively.receive("POLYDATA");
    REQUIRE(received);
    CHECK(big_endian_float(received->content, 40) == -static_cast<float>(number));
    REQUIRE(number < 10'000);
    server->show(large_update(++number));
  }
  MESSAGE(number, " meshes of 4.4 MB went to the other one");
  CHECK(number > 1);
  REQUIRE(wait_for(*server, [](const auto& counts) { return counts.clients == 1; }));
  CHECK(lively.receive("POLYDATA"));
  CHECK(frozen.closed());
  CHECK(server->counts().accepted == 2);
}

TEST_CASE("igtl clients: a slow one gets the newest mesh next, not those that it missed") {
  igtl::ServerOptions options;
  options.patience = std::chrono::hours(1);
  const auto server = serve(options);
  server->show(large_update(1));
  IgtlClient slow(server->port(), 4096), quick(server->port());
  REQUIRE(quick.receive("POLYDATA"));
  constexpr std::uint64_t kLast = 12;
  for (std::uint64_t number = 2; number <= kLast; ++number) {
    server->show(large_update(number));
    REQUIRE(quick.receive("POLYDATA"));
  }
  std::vector<float> seen;
  while (seen.empty() || seen.back() != -static_cast<float>(kLast)) {
    const auto received = slow.receive("POLYDATA");
    REQUIRE(received);
    seen.push_back(big_endian_float(received->content, 40));
  }
  CHECK(seen.size() <= 3);
}

TEST_CASE("igtl clients: one that vanishes in the middle of a message takes nobody with it") {
  const auto server = serve();
  server->show(large_update(1));
  const Bytes half = message("GET_STATUS", "");
  IgtlClient stays(server->port());
  for (int i = 0; i < 5; ++i) {
    IgtlClient goes(server->port(), 4096);
    REQUIRE(goes.ask("GET_POLYDATA"));
    REQUIRE(goes.receive(std::chrono::milliseconds(0)) == std::nullopt);
    if (i % 2 == 0) REQUIRE(goes.send(std::span(half).first(30)));
    REQUIRE(wait_for(*server, [&](const auto& counts) { return counts.clients == 2; }));
    goes.vanish();
    REQUIRE(wait_for(*server, [](const auto& counts) { return counts.clients == 1; }));
  }
  CHECK(stays.receive("POLYDATA"));
  CHECK(server->counts().frozen == 0);
  CHECK(server->counts().foreign == 0);
}

TEST_CASE("igtl clients: one that asks and never reads is not listened to any more, then closed") {
  igtl::ServerOptions options;
  options.patience = std::chrono::milliseconds(500);
  const auto server = serve(options);
  server->show(large_update(1));
  IgtlClient greedy(server->port(), 4096);
  const Bytes question = message("GET_POLYDATA", "");
  while (greedy.send(question)) continue;
  CHECK(wait_for(*server, [](const auto& counts) { return counts.frozen == 1; }));
  CHECK(server->counts().surfaces == 0);
}

TEST_CASE("igtl clients: what is no OpenIGTLink closes the connection, what is merely unknown does not") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  const std::string http = "GET / HTTP/1.1\r\nHost: localhost:18944\r\nUser-Agent: a browser\r\nAccept: */*\r\n\r\n";
  IgtlClient browser(server->port()), decent(server->port());
  REQUIRE(browser.send(std::as_bytes(std::span(http))));
  CHECK(browser.closed());
  CHECK(wait_for(*server, [](const auto& counts) { return counts.foreign == 1; }));

  Bytes spoilt = message("STT_TDATA", "", Bytes(36));
  spoilt.back() ^= std::byte{1};
  REQUIRE(decent.send(spoilt));
  REQUIRE(decent.ask("IMAGE", "camera", Bytes(1'000'000)));
  REQUIRE(decent.ask("STT_TDATA", "", Bytes(35)));
  REQUIRE(decent.ask("GET_POLYDATA"));
  CHECK(decent.receive().value().type == "POLYDATA");
  REQUIRE(wait_for(*server, [](const auto& counts) { return counts.ignored == 3; }));
  CHECK(server->counts().foreign == 1);
}

TEST_CASE("igtl clients: noise from one of them changes nothing for another") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  IgtlClient decent(server->port());
  std::mt19937 random(11);
  for (int round = 0; round < 50; ++round) {
    IgtlClient noisy(server->port());
    Bytes noise = round % 2 == 0 ? Bytes{} : message("STT_TDATA", "", Bytes(36), 2);
    for (int i = 0; i < 5000; ++i) noise.push_back(static_cast<std::byte>(random() & 0xFF));
    if (!noisy.send(noise)) continue;
    REQUIRE(decent.ask("GET_POLYDATA"));
    REQUIRE(decent.receive("POLYDATA"));
  }
  CHECK(wait_for(*server, [](const auto& counts) { return counts.foreign == 50; }));
}

TEST_CASE("igtl clients: sixteen at once; the next is served when one has gone") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  std::deque<IgtlClient> clients;
  for (int i = 0; i < 17; ++i) REQUIRE(clients.emplace_back(server->port()).ask("GET_POLYDATA"));
  for (int i = 0; i < 16; ++i) REQUIRE(clients[static_cast<std::size_t>(i)].receive("POLYDATA"));
  CHECK(server->counts().clients == 16);
  CHECK(!clients.back().receive(std::chrono::milliseconds(200)));
  clients.pop_front();
  CHECK(clients.back().receive("POLYDATA"));
}

TEST_CASE("igtl clients: the server may go while they are served") {
  for (int i = 0; i < 5; ++i) {
    auto server = serve();
    server->show(large_update(1));
    IgtlClient client(server->port(), 4096), idle(server->port());
    REQUIRE(client.ask("GET_POLYDATA"));
    REQUIRE(wait_for(*server, [](const auto& counts) { return counts.clients == 2; }));
    server.reset();
    CHECK(client.closed());
    CHECK(idle.closed());
  }
}

TEST_CASE("igtl clients: a port in use and a wrong address are errors that say what to do") {
  const auto server = serve();
  igtl::ServerOptions options;
  options.port = server->port();
  const auto second = igtl::Server::start(options);
  REQUIRE(!second);
  CHECK(second.error().code == ErrorCode::io_failed);
  CHECK(second.error().message == "port " + std::to_string(server->port()) +
                                      " of 127.0.0.1 is in use: end the program that listens there, or choose another "
                                      "port");
  for (const char* address : {"localhost", "", "127.0.0.1.5", "192.0.2.1", "2001:db8::1"}) {
    options.address = address;
    const auto nowhere = igtl::Server::start(options);
    REQUIRE_MESSAGE(!nowhere, address);
    CHECK(nowhere.error().code == ErrorCode::invalid_argument);
  }
  options.address = "0.0.0.0";
  options.port = 0;
  const auto everywhere = igtl::Server::start(options);
  REQUIRE(everywhere);
  IgtlClient client((*everywhere)->port());
  REQUIRE(client.ask("GET_STATUS"));
  CHECK(client.receive());
}
