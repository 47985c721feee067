#pragma once
#include <doctest/doctest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <utility>

#include "host/igtl/server.h"
#include "host/scan/mesh_update.h"
#include "tests/support/twin_boxes.h"
#include "tests/unit/igtl/closed_surface.h"
#include "tests/unit/igtl/igtl_client.h"

namespace sonoloft::test {

/// Nothing but a mesh and its revision.
inline std::shared_ptr<const MeshUpdate> update_of(MeshSnapshot mesh, std::uint64_t revision = 1) {
  auto update = std::make_shared<MeshUpdate>();
  update->revision = revision;
  update->mesh = std::move(mesh);
  return update;
}

/// A server on any free port that shows meshes as soon as it gets them.
inline std::unique_ptr<igtl::Server> serve(igtl::ServerOptions options = {}) {
  options.port = 0;
  options.mesh_interval = {};
  auto server = igtl::Server::start(std::move(options));
  if (!server) FAIL(server.error().message);
  return std::move(*server);
}

/// Waits until the server's counts are so. @return false: they never are
inline bool wait_for(const igtl::Server& server, const std::function<bool(const igtl::ServerCounts&)>& so) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!so(server.counts())) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

/// A surface of some megabytes, another one for every number.
inline std::shared_ptr<const MeshUpdate> large_update(std::uint64_t number) {
  constexpr std::uint32_t kTriangles = 100'000;
  auto chunk = std::make_shared<MeshChunk>();
  for (std::uint32_t i = 0; i < 3 * kTriangles; ++i) {
    chunk->positions.emplace_back(static_cast<float>(number), static_cast<float>(i), 0.0f);
    chunk->vertex_keys.push_back(i);
  }
  for (std::uint32_t i = 0; i < kTriangles; ++i) chunk->triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  chunk->label_front.assign(kTriangles, 0);
  chunk->label_back.assign(kTriangles, 1);
  return update_of({{chunk}}, number);
}

}  // namespace sonoloft::test
