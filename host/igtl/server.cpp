#include "host/igtl/server.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <list>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "host/igtl/client.h"
#include "host/igtl/listener.h"

namespace sonoloft::igtl {
namespace {

constexpr std::size_t kMaxClients = 16;  // more wait until one goes
constexpr int kTick_ms = 20;             // how often clocks are looked at while there are clients
constexpr int kRest = 8;  // times as long as making a mesh's messages took: the scan needs the processor more

using Clock = Client::Clock;

}  // namespace

class Server::Loop {
 public:
  Loop(ServerOptions options, const Listener& listener, int wake)
      : options_(std::move(options)), listener_(listener), wake_(wake), scene_(options_.labels), thread_([this] {
          serve();
        }) {}
  ~Loop();

  const Listener& listener() const { return listener_; }

  // Any thread.
  void show(std::shared_ptr<const MeshUpdate> update) { put(update_, std::move(update)); }
  void show(std::shared_ptr<const device::DeliveredSlice> slice) { put(slice_, std::move(slice)); }
  ServerCounts counts() const;

 private:
  template <class Shown>
  void put(Shown& slot, Shown shown);
  void serve();
  std::vector<pollfd> gather() const;
  bool take_in(Clock::time_point now);
  void accept(Clock::time_point now);
  bool keep(Client& client, int events, Clock::time_point now);

  const ServerOptions options_;
  const Listener listener_;
  const int wake_;  ///< an eventfd

  // The loop's.
  Scene scene_;
  std::list<Client> clients_;
  ServerCounts tally_;
  Clock::time_point next_mesh_{};  ///< not before
  bool deaf_ = false;              ///< a client could not be taken in: not before the next tick

  mutable std::mutex mutex_;                             ///< guards what follows; held for moments
  std::shared_ptr<const MeshUpdate> update_;             ///< the newest that is no message yet
  std::shared_ptr<const device::DeliveredSlice> slice_;  ///< the same
  ServerCounts counts_;
  bool stopping_ = false;
  std::jthread thread_;
};

Server::Loop::~Loop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  eventfd_write(wake_, 1);
  thread_.join();
  close(listener_.socket);
  close(wake_);
}

// ---- any thread

template <class Shown>
void Server::Loop::put(Shown& slot, Shown shown) {
  {
    const std::lock_guard lock(mutex_);
    slot.swap(shown);  // what is replaced may be the last of its kind, and goes without the lock
  }
  eventfd_write(wake_, 1);
}

ServerCounts Server::Loop::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

// ---- the loop

void Server::Loop::serve() {
  while (take_in(Clock::now())) {
    auto polled = gather();
    const bool idle = !std::exchange(deaf_, false) && clients_.empty();
    if (poll(polled.data(), polled.size(), idle ? -1 : kTick_ms) < 0) continue;  // a signal
    eventfd_t ignored;
    eventfd_read(wake_, &ignored);
    const auto now = Clock::now();
    auto events = polled.begin() + 2;
    for (auto client = clients_.begin(); client != clients_.end(); ++events)
      client = keep(*client, events->revents, now) ? std::next(client) : clients_.erase(client);
    if (polled[1].revents != 0) accept(now);
  }
}

/// @return false: it is over
bool Server::Loop::take_in(Clock::time_point now) {
  std::shared_ptr<const MeshUpdate> update;
  std::shared_ptr<const device::DeliveredSlice> slice;
  {
    const std::lock_guard lock(mutex_);
    tally_.clients = clients_.size();
    counts_ = tally_;
    if (stopping_) return false;
    slice = std::exchange(slice_, nullptr);
    if (!clients_.empty() && now >= next_mesh_) update = std::exchange(update_, nullptr);
  }
  if (slice) scene_.show(*slice);
  if (update) {
    scene_.show(*update);
    next_mesh_ = now + std::max<Clock::duration>(options_.mesh_interval, kRest * (Clock::now() - now));
  }
  return true;
}

std::vector<pollfd> Server::Loop::gather() const {
  const bool room = clients_.size() < kMaxClients && !deaf_;
  std::vector<pollfd> polled{{wake_, POLLIN, 0}, {listener_.socket, static_cast<short>(room ? POLLIN : 0), 0}};
  for (const Client& client : clients_) {
    const int events = (client.wants_to_receive() ? POLLIN : 0) | (client.wants_to_send() ? POLLOUT : 0);
    polled.push_back({client.socket(), static_cast<short>(events), 0});
  }
  return polled;
}

void Server::Loop::accept(Clock::time_point now) {
  const int socket = accept_client(listener_.socket, options_.patience);
  deaf_ = socket < 0;
  if (deaf_) return;
  clients_.emplace_back(socket, now);
  ++tally_.accepted;
}

bool Server::Loop::keep(Client& client, int events, Clock::time_point now) {
  auto state = Client::State::fine;
  if ((events & ~POLLOUT) != 0) state = client.receive(tally_);
  if (state == Client::State::fine) state = client.send(scene_, now, options_.patience, tally_);
  if (state == Client::State::foreign) ++tally_.foreign;
  if (state == Client::State::frozen) ++tally_.frozen;
  return state == Client::State::fine;
}

// ---- the server

Server::Server(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
Server::~Server() = default;

Result<std::unique_ptr<Server>> Server::start(ServerOptions options) {
  const auto listener = listen_on(options.address, options.port);
  if (!listener) return tl::unexpected<Error>(listener.error());
  const int wake = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (wake < 0) {
    close(listener->socket);
    return fail(ErrorCode::io_failed, "this program has too many files open: close some, or raise `ulimit -n`");
  }
  return std::unique_ptr<Server>(new Server(std::make_unique<Loop>(std::move(options), *listener, wake)));
}

std::uint16_t Server::port() const {
  return loop_->listener().port;
}

void Server::show(std::shared_ptr<const MeshUpdate> update) {
  loop_->show(std::move(update));
}

void Server::show(std::shared_ptr<const device::DeliveredSlice> slice) {
  loop_->show(std::move(slice));
}

ServerCounts Server::counts() const {
  return loop_->counts();
}

}  // namespace sonoloft::igtl
