#pragma once
#include <doctest/doctest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/view/view_server.h"
#include "tests/support/ball_scan.h"

namespace sonoloft::test {

/// A server on any free port; null, and says so, where the program was built without the page.
inline std::unique_ptr<view::ViewServer> open_server(view::ViewSource source = {},
                                                     const std::string& address = "127.0.0.1") {
  auto server = view::ViewServer::open({address, std::uint16_t{0}}, std::move(source));
  if (server) return std::move(*server);
  REQUIRE(server.error().code == ErrorCode::not_available);
  MESSAGE("SKIP: " << server.error().message);
  return nullptr;
}

inline std::uint16_t port_of(const view::ViewServer& server) {
  const std::string& url = server.url();
  return static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
}

/// The meshes of a scan of the ball, slice by slice.
inline std::vector<std::shared_ptr<const MeshUpdate>> ball_updates(std::uint32_t slices) {
  device_sim::LoopbackDevice device(ball_device_options(), ball_source(slices));
  ScanInbox inbox;
  const auto scan = open_scan(device.port());
  REQUIRE(scan->start(inbox.callbacks()));
  REQUIRE(inbox.wait_for(ScanEventKind::end_of_data));
  scan->stop();
  return inbox.updates();
}

}  // namespace sonoloft::test
