#include "device_sim/port/usb/in_endpoint.h"

#include <doctest/doctest.h>

#include <condition_variable>
#include <mutex>

using namespace sonoloft;
using namespace sonoloft::device_sim::usb;

TEST_CASE("in endpoint: what was being fetched when the bus was reset does not come after it") {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t asked = 0;
  bool allowed = false;
  std::vector<std::pair<std::uint64_t, std::byte>> done;
  InEndpoint endpoint(
      512, 1024,
      [&](std::span<std::byte> message) {  // the first message is 1, and takes until it is allowed
        std::unique_lock lock(mutex);
        message[0] = static_cast<std::byte>(++asked);
        changed.notify_all();
        changed.wait(lock, [&] { return allowed; });
        return protocol::PortTransfer{protocol::PortStatus::ok, 1};
      },
      [&](const UrbDone& urb) {
        const std::lock_guard lock(mutex);
        done.emplace_back(urb.id, urb.data[0]);
        changed.notify_all();
      });

  endpoint.submit(1, 1024);
  std::unique_lock lock(mutex);
  changed.wait(lock, [&] { return asked == 1; });
  lock.unlock();
  endpoint.reset();
  endpoint.submit(2, 1024);
  lock.lock();
  allowed = true;
  changed.notify_all();
  changed.wait(lock, [&] { return !done.empty(); });
  CHECK(done.front() == std::pair<std::uint64_t, std::byte>(2, std::byte{2}));
}
