#include "host/view/view_server.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <thread>
#include <utility>

#include "host/view/scene/inbox.h"
#include "host/view/serve/page_files.h"
#include "host/view/serve/service.h"
#include "host/view/serve/viewer.h"

namespace sonoloft::view {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// @return what was wrong
error_code listen(tcp::acceptor& acceptor, const tcp::endpoint& at) {
  error_code error;
  acceptor.open(at.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(at, error);
  if (!error) acceptor.listen(tcp::acceptor::max_listen_connections, error);
  if (error) acceptor.close();
  return error;
}

}  // namespace

struct ViewServer::State {
  std::unique_ptr<Service> service;  // outlives the connections, which io holds
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  std::string url;
  Inbox inbox;
  std::thread thread;

  void accept() {
    acceptor.async_accept([this](const error_code& error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) serve_http(std::move(socket), *service);
      accept();
    });
  }

  void look() {
    service->scene.take(inbox.take());
    auto& viewers = service->viewers;
    std::erase_if(viewers, [](const std::weak_ptr<Viewer>& viewer) { return viewer.expired(); });
    for (const auto& viewer : viewers)
      if (const auto alive = viewer.lock()) alive->wake();
  }

  template <class Thing>
  void hand_over(Thing thing) {
    if (inbox.put(std::move(thing))) asio::post(io, [this] { look(); });
  }
};

Result<std::unique_ptr<ViewServer>> ViewServer::open(const ViewOptions& options, ViewSource source) {
  if (page_files().empty())
    return fail(ErrorCode::not_available,
                "this program was built without the viewer's page: install npm and build again (docs/viewer.md)");
  error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error)
    return fail(ErrorCode::invalid_argument,
                options.address + " is no numeric address: give one of this machine, e.g. 127.0.0.1");
  auto state = std::make_unique<State>();
  error = listen(state->acceptor, {address, options.port.value_or(kDefaultPort)});
  if (error && !options.port) error = listen(state->acceptor, {address, 0});
  if (error)
    return fail(ErrorCode::io_failed, "cannot serve at " + options.address + ": " + error.message() +
                                          "; choose another port, or 0 for any free one");
  Door door(options.address, address.is_loopback(), state->acceptor.local_endpoint().port());
  state->url = door.url(address.is_unspecified() ? asio::ip::host_name() : "");
  state->service = std::make_unique<Service>(std::move(source), std::move(door));
  state->accept();
  state->thread = std::thread([io = &state->io] { io->run(); });
  return std::unique_ptr<ViewServer>(new ViewServer(std::move(state)));
}

ViewServer::ViewServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

ViewServer::~ViewServer() {
  state_->io.stop();
  state_->thread.join();
}

const std::string& ViewServer::url() const {
  return state_->url;
}

void ViewServer::show(std::shared_ptr<const MeshUpdate> update) {
  state_->hand_over(std::move(update));
}

void ViewServer::show(std::shared_ptr<const device::DeliveredSlice> slice) {
  if (slice->pose_status == device::PoseStatus::ok) state_->hand_over(std::move(slice));
}

void ViewServer::show(std::string state, bool running) {
  state_->hand_over(ScanState{std::move(state), running});
}

void ViewServer::show(ViewRecording recording) {
  state_->hand_over(std::move(recording));
}

ViewFigures ViewServer::figures() const {
  const Service& s = *state_->service;
  return {s.viewer_count, s.bricks_sent, s.messages_sent, s.bytes_sent, s.refused};
}

}  // namespace sonoloft::view
