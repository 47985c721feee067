#pragma once
#include <atomic>
#include <cstring>
#include <random>
#include <vector>

#include "protocol/port.h"

namespace sonoloft::test {

/// A bad cable: passes a port on and loses, alters, cuts or repeats one record in `one_in`, by a seed.
class FaultyPort final : public protocol::Port {
 public:
  FaultyPort(protocol::Port& port, std::uint32_t seed, std::uint32_t one_in)
      : port_(port), random_(seed), one_in_(one_in) {}
  ~FaultyPort() = default;

  protocol::PortTransfer control(std::span<const std::byte> request, std::span<std::byte> reply) override {
    return port_.control(request, reply);
  }
  void cancel_reads() override { port_.cancel_reads(); }
  void allow_reads() override { port_.allow_reads(); }

  protocol::PortTransfer read(std::span<std::byte> record, std::uint32_t timeout_ms) override {
    if (repeat_ > 0) {
      repeat_ = 0;
      ++repeated;
      std::memcpy(record.data(), last_.data(), last_.size());
      return {protocol::PortStatus::ok, last_.size()};
    }
    auto done = port_.read(record, timeout_ms);
    if (done.status != protocol::PortStatus::ok || random_() % one_in_ != 0) return done;
    switch (random_() % 4) {
      case 0:  // lost
        ++lost;
        return read(record, timeout_ms);
      case 1:  // altered behind the header
        record[64 + random_() % (done.size - 80)] ^= static_cast<std::byte>(1u << random_() % 8);
        ++altered;
        return done;
      case 2:  // cut short
        done.size -= 16;
        ++cut;
        return done;
      default:
        repeat_ = 1;
        last_.assign(record.begin(), record.begin() + static_cast<std::ptrdiff_t>(done.size));
        return done;
    }
  }

  // What was done, exact once the stream has stopped.
  std::atomic<std::uint64_t> lost = 0, altered = 0, cut = 0, repeated = 0;

 private:
  protocol::Port& port_;
  std::mt19937 random_;
  std::uint32_t one_in_;
  int repeat_ = 0;
  std::vector<std::byte> last_;
};

}  // namespace sonoloft::test
