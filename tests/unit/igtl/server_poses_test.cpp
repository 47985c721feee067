// Which poses clients get, and other signs of life.
#include <doctest/doctest.h>

#include "tests/unit/igtl/served.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

std::shared_ptr<const device::DeliveredSlice> slice_at(double x_mm,
                                                       device::PoseStatus status = device::PoseStatus::ok) {
  auto slice = std::make_shared<device::DeliveredSlice>();
  slice->slice.image_to_reference.translation() << x_mm, 20, 30;
  slice->pose_status = status;
  slice->arrival = std::chrono::steady_clock::now();
  return slice;
}

Bytes every(std::uint32_t interval_ms) {
  Bytes content;
  append_big_endian(content, interval_ms, 4);
  content.resize(36);
  return content;
}

}  // namespace

TEST_CASE("igtl poses: a client that listens gets each as a TRANSFORM from the image to RAS") {
  const auto server = serve();
  IgtlClient client(server->port());
  for (const double x : {1.0, 2.0, 2.0}) {  // a probe that is held still is news, too
    server->show(slice_at(x));
    const auto received = client.receive("TRANSFORM");
    REQUIRE(received);
    CHECK(received->device == "ImageToReference");
    const std::array<float, 12> columns{-1, 0, 0, 0, -1, 0, 0, 0, 1, static_cast<float>(-x), -20, 30};
    REQUIRE(received->content.size() == 48);
    for (std::size_t i = 0; i < 12; ++i) CHECK(big_endian_float(received->content, 4 * i) == columns[i]);
  }
  CHECK(wait_for(*server, [](const auto& counts) { return counts.poses == 3; }));
}

TEST_CASE("igtl poses: one that is not ok is not shown") {
  const auto server = serve();
  IgtlClient client(server->port());
  server->show(slice_at(1));
  REQUIRE(client.receive("TRANSFORM"));
  server->show(slice_at(2, device::PoseStatus::out_of_view));
  server->show(slice_at(3, device::PoseStatus::missing));
  CHECK(client.receive().value().type == "STATUS");
  server->show(slice_at(4));
  const auto received = client.receive("TRANSFORM");
  REQUIRE(received);
  CHECK(big_endian_float(received->content, 36) == -4);
}

TEST_CASE("igtl poses: STT_TDATA is confirmed and brings TDATA, as often as it asks for; STP_TDATA ends it") {
  const auto server = serve();
  server->show(slice_at(1));
  IgtlClient client(server->port());
  REQUIRE(client.ask("STT_TDATA", "client", every(300)));
  const auto confirmed = client.receive();
  REQUIRE(confirmed);
  CHECK(confirmed->type == "RTS_TDATA");
  CHECK(confirmed->content == Bytes(1));
  const auto begin = std::chrono::steady_clock::now();
  int count = 0;
  for (int x = 2; x < 300; ++x) {
    server->show(slice_at(x));
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    while (const auto received = client.receive(std::chrono::milliseconds(0))) {
      CHECK(received->type == "TDATA");
      REQUIRE(received->content.size() == 70);
      ++count;
    }
  }
  MESSAGE(count, " of 299 poses");
  CHECK(count >= 2);
  CHECK(count <= (std::chrono::steady_clock::now() - begin) / std::chrono::milliseconds(300) + 2);
  REQUIRE(client.ask("STP_TDATA"));
  REQUIRE(client.receive("RTS_TDATA"));
  server->show(slice_at(301));
  CHECK(!client.receive(std::chrono::seconds(3)));
}

TEST_CASE("igtl poses: a client that listens may have TDATA instead of TRANSFORM, and keeps its meshes") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  IgtlClient client(server->port());
  REQUIRE(client.receive("POLYDATA"));
  REQUIRE(client.receive("POLYDATA"));
  REQUIRE(client.ask("STT_TDATA", "", every(0)));
  REQUIRE(client.receive("RTS_TDATA"));
  server->show(slice_at(5));
  CHECK(client.receive().value().type == "TDATA");
  server->show(update_of(twin_boxes(2)));
  CHECK(client.receive().value().type == "POLYDATA");
  REQUIRE(client.ask("STP_TDATA"));
  REQUIRE(client.receive("RTS_TDATA"));
  server->show(slice_at(6));
  CHECK(client.receive().value().type == "TRANSFORM");
}

TEST_CASE("igtl poses: GET_STATUS is answered, and silence is broken by a STATUS") {
  const auto server = serve();
  IgtlClient client(server->port());
  REQUIRE(client.ask("STATUS", "client", Bytes(31)));  // a sign of life of its own
  for (int i = 0; i < 2; ++i) {
    if (i == 0) REQUIRE(client.ask("GET_STATUS"));
    const auto received = client.receive();
    REQUIRE(received);
    CHECK(received->type == "STATUS");
    CHECK(received->device == "SonoLoft");
    CHECK(big_endian(received->content, 0, 2) == 1);
  }
  CHECK(server->counts().ignored == 0);
}
