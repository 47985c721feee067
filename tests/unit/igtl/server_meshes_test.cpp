// Which meshes clients get, and when.
#include <doctest/doctest.h>

#include <map>

#include "tests/unit/igtl/served.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

/// The mesh of only one of the two boxes' labels: what bounds the other is gone.
MeshSnapshot without(Label gone) {
  auto chunk = std::make_shared<MeshChunk>(*twin_boxes().chunks.front());
  for (std::size_t t = chunk->triangles.size(); t-- > 0;) {
    for (Label* side : {&chunk->label_front[t], &chunk->label_back[t]})
      if (*side == gone) *side = kOutside;
    if (chunk->label_front[t] != chunk->label_back[t]) continue;
    const auto at = static_cast<std::ptrdiff_t>(t);
    chunk->triangles.erase(chunk->triangles.begin() + at);
    chunk->label_front.erase(chunk->label_front.begin() + at);
    chunk->label_back.erase(chunk->label_back.begin() + at);
  }
  return {{chunk}};
}

}  // namespace

TEST_CASE("igtl meshes: a client that listens gets every label, whole, each under its name") {
  igtl::ServerOptions options;
  REQUIRE(options.labels.add(5, "spleen", {1, 2, 3}));
  const auto server = serve(options);
  server->show(update_of(twin_boxes()));
  IgtlClient client(server->port());
  std::map<std::string, Polydata> got;
  for (int i = 0; i < 2; ++i) {
    const auto received = client.receive();
    REQUIRE(received);
    CHECK(received->type == "POLYDATA");
    CHECK(received->version == 1);
    CHECK((received->timestamp >> 32) > 1'600'000'000);
    got[received->device] = polydata(received->content);
  }
  REQUIRE(got.size() == 2);
  for (const char* name : {"label 2", "spleen"}) {
    CAPTURE(name);
    CHECK(got[name].points.size() == 8);
    CHECK(got[name].triangles.size() == 12);
    CHECK(is_closed(got[name].triangles));
    CHECK(volume(got[name].points, got[name].triangles) == doctest::Approx(name[0] == 'l' ? 6 : 12));
    for (const auto& p : got[name].points) CHECK(p[0] <= 0);  // right is right: x is turned
  }
  CHECK(got["spleen"].values == std::vector<float>(8, 5));
}

TEST_CASE("igtl meshes: what did not change is not sent again") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  IgtlClient client(server->port());
  REQUIRE(wait_for(*server, [](const auto& counts) { return counts.surfaces == 2; }));
  server->show(update_of(twin_boxes(), 2));
  server->show(update_of(twin_boxes(2), 3));
  REQUIRE(wait_for(*server, [](const auto& counts) { return counts.surfaces >= 4; }));
  for (int i = 0; i < 4; ++i) {
    const auto received = client.receive("POLYDATA");
    REQUIRE(received);
    const Polydata data = polydata(received->content);
    const double once = received->device == "label 2" ? 6 : 12;
    CHECK(volume(data.points, data.triangles) == doctest::Approx(i < 2 ? once : 8 * once));
  }
  CHECK(server->counts().surfaces == 4);
}

TEST_CASE("igtl meshes: a label that is gone becomes a point, so that its old surface goes") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  IgtlClient client(server->port());
  REQUIRE(client.receive("POLYDATA"));
  REQUIRE(client.receive("POLYDATA"));
  server->show(update_of(without(5)));
  const auto received = client.receive("POLYDATA");
  REQUIRE(received);
  CHECK(received->device == "label 5");
  const Polydata data = polydata(received->content);
  CHECK(data.points.size() == 1);
  CHECK(data.triangles.empty());
}

TEST_CASE("igtl meshes: who asks is answered, label by label, and gets nothing else") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  IgtlClient client(server->port());
  for (const char* expected : {"label 2", "label 5", "label 2", "label 5"}) {
    REQUIRE(client.ask("GET_POLYDATA", "Client"));
    const auto received = client.receive();
    REQUIRE(received);
    CHECK(received->type == "POLYDATA");
    CHECK(received->device == expected);
  }
  REQUIRE(client.ask("GET_POLYDATA", "label 2"));
  REQUIRE(client.ask("GET_POLYDATA", "label 2"));
  for (int i = 0; i < 2; ++i) CHECK(client.receive().value().device == "label 2");
  server->show(update_of(twin_boxes(2)));
  CHECK(!client.receive(std::chrono::seconds(3)));
}

TEST_CASE("igtl meshes: a question that comes before the first mesh is answered with it") {
  const auto server = serve();
  IgtlClient client(server->port());
  REQUIRE(client.ask("GET_POLYDATA"));
  REQUIRE(client.ask("GET_STATUS"));
  CHECK(client.receive().value().type == "STATUS");
  server->show(update_of(twin_boxes()));
  CHECK(client.receive().value().device == "label 2");
}

TEST_CASE("igtl meshes: version 1 is spoken until a client has sent version 2, to that client alone") {
  const auto server = serve();
  server->show(update_of(twin_boxes()));
  IgtlClient one(server->port()), two(server->port());
  for (IgtlClient* client : {&one, &two}) {
    REQUIRE(client->ask("GET_POLYDATA"));
    CHECK(client->receive().value().version == 1);
  }
  REQUIRE(two.ask("GET_POLYDATA", "", {}, 2));
  REQUIRE(one.ask("GET_POLYDATA"));
  const auto of_one = one.receive(), of_two = two.receive();
  REQUIRE(of_one);
  REQUIRE(of_two);
  CHECK(of_one->version == 1);
  CHECK(of_two->version == 2);
  CHECK(of_one->content == of_two->content);
  REQUIRE(two.ask("GET_STATUS"));
  CHECK(two.receive().value().version == 2);
}

TEST_CASE("igtl meshes: they come no faster than the interval, and the last one comes") {
  igtl::ServerOptions options;
  options.port = 0;
  const auto server = igtl::Server::start(options);
  REQUIRE(server);
  (*server)->show(update_of(twin_boxes()));
  IgtlClient client((*server)->port());
  const auto begin = std::chrono::steady_clock::now();
  REQUIRE(client.receive("POLYDATA"));
  REQUIRE(client.receive("POLYDATA"));
  constexpr int kUpdates = 200;
  for (int i = 1; i <= kUpdates; ++i) {
    (*server)->show(update_of(twin_boxes(1 + static_cast<float>(i))));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::map<std::string, int> got;
  for (double last = 0; last < 6.0 * (1 + kUpdates) * (1 + kUpdates) * (1 + kUpdates) * 0.999;) {
    const auto received = client.receive("POLYDATA");
    REQUIRE(received);
    ++got[received->device];
    const Polydata data = polydata(received->content);
    if (received->device == "label 2") last = volume(data.points, data.triangles);
  }
  const auto time = std::chrono::steady_clock::now() - begin;
  MESSAGE(got["label 2"], " of ", kUpdates, " meshes");
  const auto most = time / options.mesh_interval + 1;
  CHECK(got["label 2"] <= most);
  CHECK(got["label 2"] < kUpdates);
}
