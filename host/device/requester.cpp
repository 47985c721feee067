#include "host/device/requester.h"

#include <algorithm>
#include <thread>

namespace sonoloft::device {

using protocol::Status;

namespace {

constexpr std::chrono::milliseconds kBusyPause{10};
constexpr std::chrono::milliseconds kLongestPause{500};

std::string text(protocol::Command command) {
  return "request " + std::to_string(static_cast<unsigned>(command));
}

tl::unexpected<Error> refusal(protocol::Command command, Status status) {
  const std::string what = text(command) + " was answered with status " +
                           std::to_string(static_cast<unsigned>(status)) + " (" + protocol::name(status) + ")";
  switch (status) {
    case Status::wrong_state:
      return fail(ErrorCode::wrong_state, what + ": stop the stream first");
    case Status::not_implemented:
      return fail(ErrorCode::not_available, what + ": update the device's firmware");
    default:
      return fail(ErrorCode::refused_by_device, what + ": see docs/protocol.md, statuses");
  }
}

std::chrono::milliseconds pause_before_retry(const protocol::ReplyView& reply) {
  protocol::PendingReply pending;
  if (reply.status != Status::pending || !protocol::read_payload(reply.payload, pending)) return kBusyPause;
  return std::clamp(std::chrono::milliseconds(pending.retry_ms), kBusyPause, kLongestPause);
}

}  // namespace

Result<void> Requester::tell(protocol::Command command, std::span<const std::byte> payload,
                             std::chrono::milliseconds patience) {
  const std::lock_guard lock(mutex_);
  const auto bytes = exchange(command, payload, patience);
  if (!bytes) return tl::unexpected(bytes.error());
  return {};
}

Result<std::span<const std::byte>> Requester::exchange(protocol::Command command, std::span<const std::byte> payload,
                                                       std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  const std::uint32_t id = next_id_++;
  const auto request = std::span(request_).first(protocol::encode_request(command, id, payload, request_));
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    const auto reply = exchange_once(request, id, std::max(left, kBusyPause));
    if (!reply) return tl::unexpected(reply.error());
    if (reply->status == Status::ok) return reply->payload;
    if (reply->status != Status::pending && reply->status != Status::busy) return refusal(command, reply->status);
    const auto pause = pause_before_retry(*reply);
    if (Clock::now() + pause >= deadline) {
      return fail(ErrorCode::timed_out,
                  text(command) + " was put off for " + std::to_string(patience.count()) + " ms: restart the device");
    }
    std::this_thread::sleep_for(pause);
  }
}

Result<protocol::ReplyView> Requester::exchange_once(std::span<const std::byte> request, std::uint32_t request_id,
                                                     std::chrono::milliseconds timeout) {
  const auto size = transport_.control(request, reply_, timeout);
  if (!size) return tl::unexpected(size.error());
  const auto reply = protocol::parse_reply(std::span<const std::byte>(reply_).first(std::min(*size, reply_.size())));
  if (!reply) return fail(ErrorCode::protocol_mismatch, "the device's reply is cut off: update its firmware");
  if (reply->request_id != request_id) {
    return fail(ErrorCode::protocol_mismatch, "the device answered request " + std::to_string(reply->request_id) +
                                                  " instead of " + std::to_string(request_id) +
                                                  ": close other programs that use it, then open it again");
  }
  return *reply;
}

tl::unexpected<Error> Requester::short_reply(protocol::Command command, std::size_t have, std::size_t need) {
  return fail(ErrorCode::protocol_mismatch, text(command) + ": the reply is too short, have " + std::to_string(have) +
                                                " bytes, need " + std::to_string(need) +
                                                ": update the device's firmware");
}

}  // namespace sonoloft::device
