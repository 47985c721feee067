#pragma once
#include <atomic>

#include "protocol/port.h"

namespace sonoloft::test {

/// A port whose transfers never end, until it is let go.
class HangingPort final : public protocol::Port {
 public:
  ~HangingPort() = default;
  protocol::PortTransfer control(std::span<const std::byte>, std::span<std::byte>) override { return hang(); }
  protocol::PortTransfer read(std::span<std::byte>, std::uint32_t) override { return hang(); }
  protocol::PortTransfer read_event(std::span<std::byte>, std::uint32_t) override { return hang(); }
  protocol::PortTransfer write_block(std::span<const std::byte>) override { return hang(); }
  void cancel_reads() override { release(); }
  void allow_reads() override {}
  void release() { released_ = true, released_.notify_all(); }

 private:
  protocol::PortTransfer hang() {
    released_.wait(false);
    return {protocol::PortStatus::gone, 0};
  }
  std::atomic<bool> released_ = false;
};

}  // namespace sonoloft::test
