#include "device_sim/port/usb/out_endpoint.h"

#include <doctest/doctest.h>

#include <condition_variable>
#include <mutex>

using namespace sonoloft;
using namespace sonoloft::device_sim::usb;

namespace {

constexpr std::size_t kPacket = 64, kMost = 300;

// An endpoint with what it took and what it completed.
class Bench {
 public:
  Bench()
      : endpoint(
            kPacket, kMost,
            [this](std::span<const std::byte> message) {
              const std::lock_guard lock(mutex_);
              messages_.push_back(message.size());
              return protocol::PortTransfer{status, message.size()};
            },
            [this](const UrbDone& urb) {
              const std::lock_guard lock(mutex_);
              done_.push_back({urb.id, urb.status, {}, urb.size});
              changed_.notify_all();
            }) {}

  void send(std::uint64_t id, std::size_t len) {
    endpoint.submit({.id = id, .endpoint = 1, .data = std::vector<std::byte>(len)});
  }
  // The status of each, in order.
  std::vector<UrbStatus> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return done_.size() >= count; });
    std::vector<UrbStatus> statuses;
    for (const UrbDone& urb : done_) statuses.push_back(urb.status);
    return statuses;
  }
  std::vector<std::size_t> messages() {
    const std::lock_guard lock(mutex_);
    return messages_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::size_t> messages_;
  std::vector<UrbDone> done_;

 public:
  protocol::PortStatus status = protocol::PortStatus::ok;
  OutEndpoint endpoint;
};

using Sizes = std::vector<std::size_t>;

}  // namespace

TEST_CASE("out endpoint: a message goes from the begin of a packet to a short one, over as many URBs as it takes") {
  Bench bench;
  bench.send(1, 10);
  bench.send(2, 128);
  bench.send(3, 64);
  bench.send(4, 7);
  bench.send(5, 64);
  bench.send(6, 0);
  CHECK(bench.wait_for(6) == std::vector<UrbStatus>(6, UrbStatus::ok));
  CHECK(bench.messages() == Sizes{10, 199, 64});
}

TEST_CASE("out endpoint: a message that is too long is thrown away, and the next one is whole") {
  Bench bench;
  bench.send(1, 256);
  bench.send(2, 64 * 1000);
  bench.send(3, 1);
  bench.send(4, 300);
  bench.send(5, 301);
  (void)bench.wait_for(5);
  CHECK(bench.messages() == Sizes{300});
}

TEST_CASE("out endpoint: halted it stalls, and afterwards begins with a message") {
  Bench bench;
  bench.send(1, 64);
  (void)bench.wait_for(1);
  bench.endpoint.halt();
  CHECK(bench.endpoint.halted());
  bench.send(2, 5);
  CHECK(bench.wait_for(2).back() == UrbStatus::stalled);
  bench.endpoint.clear_halt();
  bench.send(3, 5);
  CHECK(bench.wait_for(3).back() == UrbStatus::ok);
  CHECK(bench.messages() == Sizes{5});
}

TEST_CASE("out endpoint: with the device gone everything ends") {
  Bench bench;
  bench.status = protocol::PortStatus::gone;
  bench.send(1, 5);
  CHECK(bench.wait_for(1).back() == UrbStatus::gone);
  bench.send(2, 64);
  CHECK(bench.wait_for(2).back() == UrbStatus::gone);
}
