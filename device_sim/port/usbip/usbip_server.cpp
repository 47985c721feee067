#include "device_sim/port/usbip/usbip_server.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "device_sim/port/local_listener.h"

namespace sonoloft::device_sim::usbip {
namespace {

constexpr std::size_t kMaxClients = 16;
constexpr std::size_t kMaxPending = 4096;  // URBs; Linux has about 16 under way
constexpr std::size_t kReceiveLen = 1u << 16;

}  // namespace

UsbipServer::Made UsbipServer::start(protocol::Port& port, const usb::UsbIdentity& identity, std::uint16_t tcp_port) {
  LocalListener listener = listen_locally(tcp_port);
  if (!listener.error.empty()) return {nullptr, std::move(listener.error)};
  const int wake = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  return {std::unique_ptr<UsbipServer>(new UsbipServer(port, identity, listener.socket, wake, listener.port)), {}};
}

UsbipServer::UsbipServer(protocol::Port& port, const usb::UsbIdentity& identity, int listener, int wake,
                         std::uint16_t tcp_port)
    : listener_(listener),
      wake_(wake),
      tcp_port_(tcp_port),
      device_(port, identity, [this](const usb::UrbDone& done) { complete(done); }),
      thread_([this] { serve(); }) {}

UsbipServer::~UsbipServer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  eventfd_write(wake_, 1);
  thread_.join();
  for (Client& client : clients_) drop(client);
  close(listener_);
  close(wake_);
}

// ---- the loop

void UsbipServer::serve() {
  std::vector<pollfd> polled;
  while (gather(polled)) {
    if (poll(polled.data(), polled.size(), -1) < 0) continue;  // a signal
    eventfd_t ignored;
    eventfd_read(wake_, &ignored);
    auto events = polled.begin() + 2;
    for (auto client = clients_.begin(); client != clients_.end(); ++events) {
      if (serve(*client, events->revents)) {
        ++client;
      } else {
        drop(*client);
        client = clients_.erase(client);
      }
    }
    if (polled[0].revents != 0) accept_client();
  }
}

bool UsbipServer::gather(std::vector<pollfd>& polled) {
  const std::lock_guard lock(mutex_);
  polled = {{listener_, POLLIN, 0}, {wake_, POLLIN, 0}};
  for (const Client& client : clients_) {
    const bool more = client.sent < client.to_send.size() || client.closing;
    polled.push_back({client.socket, static_cast<short>(more ? POLLIN | POLLOUT : POLLIN), 0});
  }
  return !stopping_;
}

void UsbipServer::accept_client() {
  const int socket = device_sim::accept_client(listener_);
  if (socket < 0) return;
  if (clients_.size() == kMaxClients) {
    close(socket);
    return;
  }
  clients_.push_back({socket});
}

bool UsbipServer::serve(Client& client, int events) {
  if ((events & ~POLLOUT) != 0 && !receive(client)) return false;
  return send(client);
}

bool UsbipServer::receive(Client& client) {
  std::array<std::byte, kReceiveLen> bytes;
  const ssize_t size = recv(client.socket, bytes.data(), bytes.size(), 0);
  if (size < 0) return errno == EAGAIN || errno == EINTR;
  if (size == 0) return false;
  client.received.insert(client.received.end(), bytes.begin(), bytes.begin() + size);
  return take_messages(client);
}

bool UsbipServer::take_messages(Client& client) {
  std::span<const std::byte> rest(client.received);
  auto next = parse(rest, client.imported);
  while (next.kind == Parsed::Kind::message) {
    if (!obey(client, *next.message)) return false;
    rest = rest.subspan(next.size);
    next = parse(rest, client.imported);
  }
  client.received.erase(client.received.begin(), client.received.end() - static_cast<std::ptrdiff_t>(rest.size()));
  return next.kind == Parsed::Kind::incomplete;
}

bool UsbipServer::obey(Client& client, Message& message) {
  if (auto* submitted = std::get_if<SubmitCommand>(&message)) {
    submit(client, std::move(submitted->urb));
  } else if (const auto* unlinked = std::get_if<UnlinkCommand>(&message)) {
    unlink(client, *unlinked);
  } else if (const auto* imported = std::get_if<ImportRequest>(&message)) {
    import(client, imported->our_device);
  } else {
    const std::lock_guard lock(mutex_);
    append_device_list(device_.descriptors(), client.to_send);
  }
  const std::lock_guard lock(mutex_);
  return client.pending <= kMaxPending;
}

void UsbipServer::import(Client& client, bool our_device) {
  const std::lock_guard lock(mutex_);
  auto status = ImportStatus::ok;
  if (!our_device) status = ImportStatus::no_device;
  if (our_device && importer_ != nullptr) status = ImportStatus::busy;
  append_import(status, device_.descriptors(), client.to_send);
  if (status != ImportStatus::ok) return;
  importer_ = &client;
  client.imported = true;
}

void UsbipServer::submit(Client& client, usb::Urb urb) {
  {
    const std::lock_guard lock(mutex_);
    ++client.pending;
  }
  device_.submit(std::move(urb));
}

void UsbipServer::unlink(Client& client, const UnlinkCommand& command) {
  const bool cancelled = device_.unlink(command.unlinked);
  const std::lock_guard lock(mutex_);
  if (cancelled) --client.pending;
  // Where it was not cancelled its completion is in to_send already, as it must be.
  append_unlink(command.seqnum, cancelled, client.to_send);
}

bool UsbipServer::send(Client& client) {
  const std::lock_guard lock(mutex_);
  const auto rest = std::span(client.to_send).subspan(client.sent);
  if (!rest.empty()) {
    const ssize_t size = ::send(client.socket, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (size < 0) return errno == EAGAIN || errno == EINTR;
    client.sent += static_cast<std::size_t>(size);
  }
  if (client.sent < client.to_send.size()) return true;
  client.to_send.clear();
  client.sent = 0;
  return !client.closing;
}

void UsbipServer::drop(Client& client) {
  if (client.imported) {
    device_.reset();  // no completion follows
    const std::lock_guard lock(mutex_);
    importer_ = nullptr;
  }
  close(client.socket);
}

// ---- the device's threads

void UsbipServer::complete(const usb::UrbDone& done) {
  const std::lock_guard lock(mutex_);
  append_submit(done, importer_->to_send);
  --importer_->pending;
  importer_->closing |= done.status == usb::UrbStatus::gone;
  eventfd_write(wake_, 1);
}

}  // namespace sonoloft::device_sim::usbip
