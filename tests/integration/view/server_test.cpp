// What the server of the live picture sends, to whom, and what it does not take.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/mesh/mesh.h"
#include "tests/integration/view/scene_client.h"
#include "tests/integration/view/view_support.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

std::size_t faces(const SceneMessage& message) {
  std::size_t count = 0;
  for (const auto& [coord, surfaces] : message.bricks)
    for (const auto& [label, surface] : surfaces) count += surface.indices.size() / 3;
  return count;
}

std::size_t faces(const MeshUpdate& update) {
  std::size_t count = 0;
  for (const LabelStatistics& label : update.labels) count += label.triangles;
  return count;
}

/// Enclosed by a label's surface, as sent.
double volume_ml(const SceneMessage& message, std::uint32_t label) {
  double sum = 0;
  for (const auto& [coord, surfaces] : message.bricks) {
    const auto surface = surfaces.find(label);
    if (surface == surfaces.end()) continue;
    const auto corner = [&](std::size_t i) {
      const auto& p = surface->second.positions.at(surface->second.indices.at(i));
      return Eigen::Vector3d(p[0], p[1], p[2]);
    };
    for (std::size_t i = 0; i < surface->second.indices.size(); i += 3)
      sum += corner(i).dot(corner(i + 1).cross(corner(i + 2))) / 6000;
  }
  return sum;
}

std::string host_of(const view::ViewServer& server) {
  return "127.0.0.1:" + std::to_string(port_of(server));
}

std::string status_line(const std::string& answer) {
  return answer.substr(0, answer.find("\r\n"));
}

}  // namespace

TEST_CASE("view: a viewer that comes late gets the whole mesh, closed surfaces of every label") {
  const auto server = open_server();
  if (!server) return;
  const auto updates = ball_updates(24);
  SceneClient present(port_of(*server));
  for (const auto& update : updates) {  // the server sees every one, and with that bricks vanish
    server->show(update);
    static_cast<void>(present.catch_up());
  }
  SceneMessage got = SceneClient(port_of(*server)).catch_up();
  const MeshUpdate& last = *updates.back();
  const std::size_t vanished = std::erase_if(got.bricks, [](const auto& brick) { return brick.second.empty(); });
  MESSAGE(got.bricks.size() << " bricks, " << vanished << " vanished, " << faces(got) << " faces, " << got.bytes
                            << " bytes");
  CHECK(got.bricks.size() == last.mesh.chunks.size());
  CHECK(got.head["bricks"]["all"] == last.mesh.chunks.size());
  CHECK(faces(got) == faces(last));
  CHECK(got.head["bricks"]["faces"] == faces(last));
  CHECK(got.head["bricks"]["triangles"] == last.mesh.indexed().triangles.size());
  CHECK(got.head["bricks"]["triangles"] < got.head["bricks"]["faces"]);  // there is a wall between both labels
  REQUIRE(got.head["labels"].size() == 2);
  for (const LabelStatistics& label : last.labels)
    CHECK(volume_ml(got, label.label) == doctest::Approx(label.volume_ml).epsilon(1e-6));
}

TEST_CASE("view: normals are smooth across bricks and point out of the label") {
  const auto server = open_server();
  if (!server) return;
  server->show(ball_updates(24).back());
  const SceneMessage got = SceneClient(port_of(*server)).catch_up();
  std::map<std::pair<std::uint32_t, std::array<float, 3>>, std::array<std::int8_t, 4>> seen;
  std::size_t shared = 0, outwards = 0, all = 0;
  for (const auto& [coord, surfaces] : got.bricks) {
    for (const auto& [label, surface] : surfaces) {
      for (std::size_t v = 0; v < surface.positions.size(); ++v) {
        const auto& p = surface.positions[v];
        const auto& n = surface.shades[v];
        const auto [before, fresh] = seen.try_emplace({label, p}, n);
        shared += fresh ? 0 : 1;
        for (std::size_t axis = 0; axis < 3; ++axis) CHECK(std::abs(before->second[axis] - n[axis]) <= 1);
        const bool hollow = label == 1 && std::hypot(p[0], p[1], p[2]) < (kBallRadius_mm + kCoreRadius_mm) / 2;
        outwards += (p[0] * n[0] + p[1] * n[1] + p[2] * n[2] > 0) != hollow ? 1u : 0u;
        ++all;
      }
    }
  }
  MESSAGE(all << " vertices, " << shared << " of them on borders of bricks, " << outwards << " point outwards");
  CHECK(shared > 100);
  CHECK(outwards == all);
}

TEST_CASE("view: only bricks that look different are sent again") {
  const auto server = open_server();
  if (!server) return;
  const auto updates = ball_updates(24);
  const MeshUpdate &before = **(updates.end() - 2), &after = *updates.back();
  server->show(*(updates.end() - 2));
  SceneClient viewer(port_of(*server));
  static_cast<void>(viewer.catch_up());
  server->show(updates.back());
  const SceneMessage got = viewer.catch_up();
  std::set<std::shared_ptr<const MeshChunk>> old(before.mesh.chunks.begin(), before.mesh.chunks.end());
  std::set<BrickCoord> changed;
  for (const auto& chunk : after.mesh.chunks)
    if (!old.contains(chunk)) changed.insert(chunk->coord);
  MESSAGE(changed.size() << " of " << after.mesh.chunks.size() << " chunks changed, " << got.bricks.size() << " sent");
  for (const BrickCoord& c : changed) CHECK(got.bricks.contains(c));
  for (const auto& [c, surfaces] : got.bricks) {
    bool beside_a_change = surfaces.empty();
    for (const BrickCoord& d : changed)
      beside_a_change =
          beside_a_change || (std::abs(c.x - d.x) <= 1 && std::abs(c.y - d.y) <= 1 && std::abs(c.z - d.z) <= 1);
    CHECK(beside_a_change);
  }
  server->show(updates.back());
  CHECK(viewer.catch_up().bricks.empty());
}

TEST_CASE("view: a viewer that was away gets the newest state of each brick once, however much happened") {
  const auto server = open_server();
  if (!server) return;
  const auto updates = ball_updates(24);
  SceneClient frozen(port_of(*server)), eager(port_of(*server));
  server->show(updates.front());
  static_cast<void>(frozen.catch_up());
  for (int round = 0; round < 20; ++round) {
    for (const auto& update : updates) server->show(update);
    static_cast<void>(eager.catch_up());
  }
  const view::ViewFigures before = server->figures();
  const SceneMessage got = frozen.catch_up();
  MESSAGE(before.bricks_sent << " bricks in " << before.messages_sent << " messages to the other one");
  CHECK(server->figures().messages_sent - before.messages_sent == 1);
  CHECK(faces(got) == faces(*updates.back()));
}

TEST_CASE("view: requests by another name, from another origin or without one are refused") {
  const auto server = open_server();
  if (!server) return;
  const std::uint16_t port = port_of(*server);
  const std::string host = host_of(*server), own = "http://" + host;
  const auto status = [&](const std::string& request) { return status_line(answer_to(port, request)); };
  CHECK(status(upgrade_request(host, own)) == "HTTP/1.1 101 Switching Protocols");
  const std::string localhost = "localhost:" + std::to_string(port);
  CHECK(status(upgrade_request(localhost, "http://" + localhost)) == "HTTP/1.1 101 Switching Protocols");
  CHECK(status(upgrade_request(host, "http://" + localhost)) == "HTTP/1.1 403 Forbidden");
  CHECK(status(upgrade_request(host, "https://example.com")) == "HTTP/1.1 403 Forbidden");
  CHECK(status(upgrade_request(host, "null")) == "HTTP/1.1 403 Forbidden");
  CHECK(status(upgrade_request(host, "")) == "HTTP/1.1 403 Forbidden");
  CHECK(status(upgrade_request("example.com", "http://example.com")) == "HTTP/1.1 421 Misdirected Request");
  CHECK(status("GET / HTTP/1.1\r\nHost: example.com\r\n\r\n") == "HTTP/1.1 421 Misdirected Request");
  CHECK(server->figures().refused == 4);
}

TEST_CASE("view: beyond this machine it takes the token") {
  const auto server = open_server({}, "0.0.0.0");
  if (!server) return;
  const std::string url = server->url();
  const std::string token = url.substr(url.find("#token=") + 7);
  CHECK(token.size() == 32);
  const std::uint16_t port = port_of(*server);
  const auto status = [&](const std::string& target) {
    return status_line(answer_to(port, upgrade_request("scanner:1", "http://scanner:1", target)));
  };
  CHECK(status("/scene?token=" + token) == "HTTP/1.1 101 Switching Protocols");
  CHECK(status("/scene") == "HTTP/1.1 403 Forbidden");
  CHECK(status("/scene?token=") == "HTTP/1.1 403 Forbidden");
  CHECK(status("/scene?token=" + std::string(32, '0')) == "HTTP/1.1 403 Forbidden");
  CHECK(status_line(answer_to(port, upgrade_request("scanner:1", "http://other:1", "/scene?token=" + token))) ==
        "HTTP/1.1 403 Forbidden");
}

TEST_CASE("view: what makes no sense is refused, and the others see on") {
  const auto server = open_server();
  if (!server) return;
  const std::uint16_t port = port_of(*server);
  const std::string head = " HTTP/1.1\r\nHost: " + host_of(*server) + "\r\n";
  const auto status = [&](const std::string& request) { return status_line(answer_to(port, request)); };
  CHECK(status("POST /" + head + "\r\n") == "HTTP/1.1 405 Method Not Allowed");
  CHECK(status("GET /../etc/passwd" + head + "\r\n") == "HTTP/1.1 404 Not Found");
  CHECK(status("GET /" + head + "X: " + std::string(100'000, 'x') + "\r\n\r\n").empty());
  CHECK(status("GET /" + head + "Content-Length: 99999999999\r\n\r\n").empty());
  CHECK(status(std::string(1000, '\0')).empty());
  SceneClient sound(port);
  for (const std::string& word : {std::string("stop"), std::string("record"), std::string("measured"),
                                  std::string("coverage"), std::string("?"), std::string(1 << 20, 'n')}) {
    SceneClient rude(port);
    try {
      rude.say(word);
    } catch (const std::exception&) {  // it hung up in the middle of the word
    }
    CHECK(rude.read() == nullptr);
  }
  server->show("still here");
  CHECK(sound.catch_up().head["state"] == "still here");
  const std::string page = answer_to(port, "GET /" + head + "\r\n");
  CHECK(status_line(page) == "HTTP/1.1 200 OK");
  CHECK(page.find("Content-Security-Policy: default-src 'none'; script-src 'self';") != std::string::npos);
}

TEST_CASE("view: a page can end the scan where the program lets it") {
  std::atomic<int> stops = 0;
  view::ViewSource source;
  source.stop = [&] { ++stops; };
  const auto server = open_server(std::move(source));
  if (!server) return;
  SceneClient viewer(port_of(*server));
  server->show("scanning", true);
  CHECK(viewer.catch_up().head["stop"] == true);
  viewer.say("stop");
  server->show("over");
  const nlohmann::json head = viewer.catch_up().head;
  CHECK(head["state"] == "over");
  CHECK(head["stop"] == false);
  CHECK(stops == 1);
}

TEST_CASE("view: a page can have the scan recorded where the program lets it, and all pages see what comes of it") {
  std::atomic<int> begun = 0, ended = 0;
  view::ViewSource source;
  source.record = [&](bool recording) { ++(recording ? begun : ended); };
  const auto server = open_server(std::move(source));
  if (!server) return;
  SceneClient viewer(port_of(*server)), other(port_of(*server));
  server->show("waiting for the probe");
  CHECK(viewer.catch_up().head["record"] == false);
  server->show("scanning", true);
  const nlohmann::json before = viewer.catch_up().head;
  CHECK(before["record"] == true);
  CHECK(!before.contains("recording"));
  viewer.say("record");
  viewer.say("record-end");
  server->show(view::ViewRecording{"recording-1.mcap", true, 2.5, 50, 1, "the disk is full"});
  for (SceneClient* page : {&viewer, &other}) {
    const nlohmann::json recording = page->catch_up().head["recording"];
    CHECK(recording == nlohmann::json{{"file", "recording-1.mcap"},
                                      {"running", true},
                                      {"seconds", 2.5},
                                      {"records", 50},
                                      {"not_recorded", 1},
                                      {"failure", "the disk is full"}});
  }
  CHECK(begun == 1);
  CHECK(ended == 1);
}
