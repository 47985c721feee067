#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <set>
#include <thread>

#include "host/igtl/server.h"
#include "tests/integration/igtl/printed.h"
#include "tests/integration/igtl/program.h"
#include "tests/support/ball_scan.h"

using namespace sonoloft;
using namespace sonoloft::test;

namespace {

constexpr std::uint32_t kSlices = 24;

/// What a scan of the ball hands out.
struct BallScan {
  std::vector<std::shared_ptr<const MeshUpdate>> meshes;
  std::vector<std::shared_ptr<const device::DeliveredSlice>> slices;
};

const BallScan& ball_scan() {
  static const BallScan scanned = [] {
    BallScan scan;
    device_sim::LoopbackDevice device(ball_device_options(), ball_source(kSlices));
    ScanInbox inbox;
    auto callbacks = inbox.callbacks();
    callbacks.on_slice = [&](auto slice) { scan.slices.push_back(std::move(slice)); };
    const auto session = open_scan(device.port());
    REQUIRE(session->start(callbacks));
    REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
    session->stop();
    scan.meshes = inbox.updates();
    return scan;
  }();
  return scanned;
}

std::unique_ptr<igtl::Server> serve(igtl::ServerOptions options = {}) {
  options.port = 0;
  auto server = igtl::Server::start(std::move(options));
  if (!server) FAIL(server.error().message);
  return std::move(*server);
}

std::vector<std::string> client_of(std::uint16_t port, std::vector<std::string> command) {
  command.insert(command.end(), {"127.0.0.1", std::to_string(port)});
  return command;
}

/// The answers to ten questions are the two labels in turn, as they are in the mesh.
void check_answers(const std::string& printed, const MeshUpdate& update) {
  const IndexedMesh mesh = update.mesh.indexed();
  const auto surfaces = surfaces_in(printed);
  REQUIRE(surfaces.size() == 10);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const auto label = static_cast<Label>(1 + i % 2);
    const PrintedSurface sent = expected(mesh, label);
    CHECK(sent.triangles.size() == update.labels[label - 1u].triangles);
    CHECK(surfaces[i].points == sent.points);
    CHECK(surfaces[i].triangles.size() == sent.triangles.size());
    CHECK((surfaces[i].triangles == sent.triangles));
    CHECK(surfaces[i].labels == sent.labels);
    CHECK(surfaces[i].labelled == sent.points);
  }
  MESSAGE("label 1: ", surfaces[0].points, " points, ", surfaces[0].triangles.size(),
          " triangles; label 2: ", surfaces[1].points, " points, ", surfaces[1].triangles.size(), " triangles");
}

/// Shows the scan's slices one after the other, a moment each, until the client has printed so many poses.
void show_slices_until(igtl::Server& server, const Program& client, std::size_t poses) {
  REQUIRE(client.wait_for([&, next = std::size_t{0}](const std::string& printed) mutable {
    server.show(ball_scan().slices[next++ % kSlices]);
    return matrices_in(printed).size() >= poses;
  }));
}

/// Every pose printed was sent, in RAS, and every one sent was printed.
void check_poses(const std::string& printed) {
  constexpr double kPrinted_mm = 1e-4;  // six digits
  const auto printed_matrices = matrices_in(printed);
  std::set<std::size_t> found;
  for (const Eigen::Matrix4d& matrix : printed_matrices) {
    const auto& slices = ball_scan().slices;
    const auto sent = std::find_if(slices.begin(), slices.end(), [&](const auto& slice) {
      Eigen::Matrix4d to_ras = slice->slice.image_to_reference.matrix();
      to_ras.topRows<2>() *= -1;
      return (matrix - to_ras).cwiseAbs().maxCoeff() < kPrinted_mm;
    });
    CHECK_MESSAGE((sent != slices.end()), "never sent: ", matrix);
    found.insert(static_cast<std::size_t>(sent - slices.begin()));
  }
  MESSAGE(printed_matrices.size(), " poses");
  CHECK(found.size() == kSlices);
}

}  // namespace

TEST_CASE("igtl examples: PolyDataClient prints the mesh that was sent, label by label, every digit") {
  const auto server = serve();
  server->show(ball_scan().meshes.back());
  server->show(ball_scan().slices.back());  // which it must not get: it takes whatever comes for the answer
  Program client(client_of(server->port(), {POLYDATA_CLIENT}));
  REQUIRE(client.wait_end());
  check_answers(client.printed(), *ball_scan().meshes.back());
}

TEST_CASE("igtl examples: ReceiveClient prints the poses that were sent, and passes over the meshes") {
  const auto server = serve();
  server->show(ball_scan().meshes.back());
  Program client(client_of(server->port(), {RECEIVE_CLIENT}));
  show_slices_until(*server, client, 3 * kSlices);
  REQUIRE(client.wait_for([](const std::string& text) { return text.find("POLYDATA") != std::string::npos; }));
  check_poses(client.printed());
}

TEST_CASE("igtl examples: of three clients one is frozen, and the others get everything") {
  igtl::ServerOptions options;
  options.patience = std::chrono::milliseconds(500);
  options.mesh_interval = std::chrono::milliseconds(20);
  const auto server = serve(options);
  const auto& meshes = ball_scan().meshes;
  server->show(meshes.back());
  Program asks(client_of(server->port(), {POLYDATA_CLIENT}));
  Program listens(client_of(server->port(), {RECEIVE_CLIENT})), freezes(client_of(server->port(), {RECEIVE_CLIENT}));
  show_slices_until(*server, freezes, 1);
  freezes.freeze();
  for (std::size_t i = 0; server->counts().frozen == 0; ++i) {
    REQUIRE(i < 10'000);
    server->show(meshes[i % meshes.size()]);
    server->show(ball_scan().slices[i % kSlices]);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  server->show(meshes.back());
  show_slices_until(*server, listens, 10 * kSlices);
  check_poses(listens.printed());
  REQUIRE(asks.wait_end());
  CHECK(surfaces_in(asks.printed()).size() == 10);
  const auto counts = server->counts();
  MESSAGE(counts.surfaces, " surfaces and ", counts.poses, " poses sent");
  CHECK(counts.accepted == 3);
  CHECK(counts.frozen == 1);
  CHECK(counts.foreign == 0);
}

TEST_CASE("igtl examples: valgrind sees no client read or write what is not its own") {
  if (std::system("command -v valgrind > /dev/null") != 0) {
    MESSAGE("SKIP: no valgrind: apt-get install valgrind");
    return;
  }
  const auto server = serve();
  server->show(ball_scan().meshes.back());
  Program asks(client_of(server->port(), {"valgrind", POLYDATA_CLIENT}));
  REQUIRE(asks.wait_end());
  check_answers(asks.printed(), *ball_scan().meshes.back());
  Program listens(client_of(server->port(), {"valgrind", RECEIVE_CLIENT}));
  show_slices_until(*server, listens, kSlices);
  REQUIRE(listens.wait_for([](const std::string& text) { return text.find("POLYDATA") != std::string::npos; }));
  for (const Program* client : {&asks, &listens}) {
    const std::string printed = client->printed();
    CHECK(printed.find("Memcheck, a memory error detector") != std::string::npos);
    CHECK(printed.find("Invalid read") == std::string::npos);
    CHECK(printed.find("Invalid write") == std::string::npos);
  }
}

TEST_CASE("igtl examples: the tool serves while it scans, and says at the end whom it served") {
  const TemporaryFolder folder;
  Program tool({SONOLOFT_TOOL, "scan", "--simulated", "--phantom", "organs", "--slices", "80", "--rate", "10",
                "--resolution-mm", "8", "--device", "cpu", "--igtl", "0", "-o", folder.path("mesh.ply").string()});
  const std::string said = "OpenIGTLink: port ";
  REQUIRE(tool.wait_for([&](const std::string& text) { return text.find(" of 127.0.0.1\n") != std::string::npos; }));
  const std::string printed = tool.printed();
  const int port = std::stoi(printed.substr(printed.find(said) + said.size()));
  Program client(client_of(static_cast<std::uint16_t>(port), {RECEIVE_CLIENT}));
  CHECK(client.wait_for([](const std::string& text) {
    return text.find("POLYDATA") != std::string::npos && !matrices_in(text).empty();
  }));
  REQUIRE(tool.wait_end());
  CHECK_MESSAGE(tool.printed().find("OpenIGTLink: clients 1 ") != std::string::npos, tool.printed());
  CHECK(client.wait_end());
}
