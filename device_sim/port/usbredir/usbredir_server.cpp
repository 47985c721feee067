#include "device_sim/port/usbredir/usbredir_server.h"

#include <poll.h>
#include <unistd.h>

#include <utility>

#include "device_sim/port/local_listener.h"
#include "device_sim/port/usbredir/guest.h"

namespace sonoloft::device_sim::usbredir {

UsbredirServer::Made UsbredirServer::start(protocol::Port& port, const usb::UsbIdentity& identity,
                                           std::uint16_t tcp_port) {
  LocalListener listener = listen_locally(tcp_port);
  if (!listener.error.empty()) return {nullptr, std::move(listener.error)};
  return {std::unique_ptr<UsbredirServer>(new UsbredirServer(port, identity, listener.socket, listener.port)), {}};
}

UsbredirServer::UsbredirServer(protocol::Port& port, const usb::UsbIdentity& identity, int listener,
                               std::uint16_t tcp_port)
    : listener_(listener),
      tcp_port_(tcp_port),
      device_(port, identity, [this](const usb::UrbDone& done) { completions_.add(done); }),
      thread_([this] { serve(); }) {}

UsbredirServer::~UsbredirServer() {
  stopping_ = true;
  completions_.wake();
  thread_.join();
  guest_.reset();
  close(listener_);
}

void UsbredirServer::serve() {
  while (true) {
    answer_guest();
    if (stopping_) return;  // looked at after every take(), which quiets the event that says so
    const short awaited = guest_ ? guest_->awaited() : short{POLLIN};
    pollfd polled[] = {{completions_.event(), POLLIN, 0}, {guest_ ? guest_->socket() : listener_, awaited, 0}};
    if (poll(polled, 2, -1) < 0) continue;  // a signal
    if (guest_) {
      serve_guest(polled[1].revents);
    } else if (const int socket = polled[1].revents != 0 ? accept_client(listener_) : -1; socket >= 0) {
      guest_ = std::make_unique<Guest>(socket, device_);
    }
  }
}

void UsbredirServer::answer_guest() {
  for (const usb::Completion& done : completions_.take()) {
    if (guest_) guest_->answer(done);
  }
}

void UsbredirServer::serve_guest(int events) {
  const bool stays = ((events & ~POLLOUT) == 0 || guest_->receive()) && guest_->send();
  if (stays) return;
  guest_.reset();
  (void)completions_.take();  // the last; the next guest has the same ids
}

}  // namespace sonoloft::device_sim::usbredir
