#include "protocol/command.h"

#include <algorithm>
#include <cassert>

namespace sonoloft::protocol {
namespace {

// Requests and replies have the same shape; the first number is a command or a status.
struct Message {
  std::uint16_t code;
  std::uint32_t request_id;
  std::span<const std::byte> payload;
};

std::size_t encode(const Message& message, std::span<std::byte> out) {
  const std::size_t len = sizeof(RequestHeader) + message.payload.size();
  assert(len <= kMaxRequestLen && len <= out.size());
  const RequestHeader header{message.code, static_cast<std::uint16_t>(message.payload.size()), message.request_id};
  std::memcpy(out.data(), &header, sizeof header);
  std::copy(message.payload.begin(), message.payload.end(), out.begin() + sizeof header);
  return len;
}

std::optional<Message> parse(std::span<const std::byte> bytes) {
  RequestHeader header;
  if (bytes.size() > kMaxRequestLen || !read_payload(bytes, header)) return std::nullopt;
  const auto payload = bytes.subspan(sizeof header);
  if (payload.size() != header.payload_len) return std::nullopt;
  return Message{header.command, header.request_id, payload};
}

}  // namespace

std::size_t encode_request(Command command, std::uint32_t request_id, std::span<const std::byte> payload,
                           std::span<std::byte> out) {
  return encode({static_cast<std::uint16_t>(command), request_id, payload}, out);
}

std::size_t encode_reply(Status status, std::uint32_t request_id, std::span<const std::byte> payload,
                         std::span<std::byte> out) {
  return encode({static_cast<std::uint16_t>(status), request_id, payload}, out);
}

std::optional<RequestView> parse_request(std::span<const std::byte> bytes) {
  const auto message = parse(bytes);
  if (!message) return std::nullopt;
  return RequestView{static_cast<Command>(message->code), message->request_id, message->payload};
}

std::optional<ReplyView> parse_reply(std::span<const std::byte> bytes) {
  const auto message = parse(bytes);
  if (!message) return std::nullopt;
  return ReplyView{static_cast<Status>(message->code), message->request_id, message->payload};
}

std::optional<Version> common_version(Version ours, Version theirs) {
  if (ours.major != theirs.major) return std::nullopt;
  return Version{ours.major, std::min(ours.minor, theirs.minor)};
}

const char* name(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::not_implemented:
      return "not_implemented";
    case Status::invalid_parameter:
      return "invalid_parameter";
    case Status::busy:
      return "busy";
    case Status::wrong_state:
      return "wrong_state";
    case Status::pending:
      return "pending";
    case Status::bad_request:
      return "bad_request";
  }
  return "unknown status";
}

}  // namespace sonoloft::protocol
