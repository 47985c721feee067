#pragma once
#include <span>

#include "protocol/block.h"
#include "protocol/command.h"
#include "protocol/event.h"
#include "protocol/port.h"
#include "tests/fuzz/input.h"

namespace sonoloft::fuzz {

inline constexpr std::size_t kRecordLen = 700;

/// Answers everything at once, so that every transfer ends.
class PromptPort final : public protocol::Port {
 public:
  ~PromptPort() = default;
  protocol::PortTransfer control(std::span<const std::byte> request, std::span<std::byte> reply) override {
    demand(request.size() <= protocol::kMaxRequestLen && reply.size() >= protocol::kMaxRequestLen);
    reply[0] = request[0];
    return {protocol::PortStatus::ok, sizeof(protocol::ReplyHeader)};
  }
  protocol::PortTransfer read(std::span<std::byte> record, std::uint32_t) override {
    demand(record.size() >= kRecordLen);
    return {protocol::PortStatus::ok, kRecordLen};
  }
  protocol::PortTransfer read_event(std::span<std::byte> event, std::uint32_t) override {
    demand(event.size() >= protocol::kEventLen);
    return {protocol::PortStatus::ok, protocol::kEventLen};
  }
  protocol::PortTransfer write_block(std::span<const std::byte> block) override {
    (void)protocol::parse_block(block);
    return {protocol::PortStatus::ok, block.size()};
  }
  void cancel_reads() override {}
  void allow_reads() override {}
};

}  // namespace sonoloft::fuzz
