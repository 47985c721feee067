#pragma once
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/view/scene/scene.h"
#include "host/view/serve/door.h"
#include "host/view/view_server.h"

namespace sonoloft::view {

class Viewer;

/// What all connections share. Threads: the server's, but for the counts.
struct Service {
  Service(ViewSource from, Door rules) : source(std::move(from)), door(std::move(rules)), scene(source) {}

  const ViewSource source;
  const Door door;
  Scene scene;
  std::vector<std::weak_ptr<Viewer>> viewers;
  std::atomic<std::size_t> connections = 0;  ///< of any kind
  std::atomic<std::size_t> viewer_count = 0;
  std::atomic<std::uint64_t> bricks_sent = 0, messages_sent = 0, bytes_sent = 0, refused = 0;

  /// More are hung up on, so that memory is bounded.
  static constexpr std::size_t kMaxConnections = 64;
};

/// Answers the requests of one connection, and makes a viewer of it when it asks for the scene.
void serve_http(boost::asio::ip::tcp::socket socket, Service& service);

}  // namespace sonoloft::view
