#pragma once
#include <chrono>
#include <cstring>
#include <functional>
#include <optional>
#include <vector>

#include "host/device/transport.h"
#include "protocol/command.h"

namespace sonoloft::test {

/// A device that answers as a test says. Every request calls `answer`; its stream is silent.
class ScriptedTransport final : public device::Transport {
 public:
  struct Answer {
    protocol::Status status = protocol::Status::ok;
    std::vector<std::byte> payload = {};
    int id_offset = 0;                  ///< added to the request's id
    std::size_t cut = 0;                ///< bytes missing at the end
    std::optional<Error> failure = {};  ///< of the transport itself
  };
  using Script = std::function<Answer(const protocol::RequestView&)>;

  explicit ScriptedTransport(Script script) : script_(std::move(script)) {}

  Result<std::size_t> control(std::span<const std::byte> request, std::span<std::byte> reply,
                              std::chrono::milliseconds timeout) override {
    const auto view = protocol::parse_request(request);
    if (!view) return fail(ErrorCode::io_failed, "the test got a request that is none");
    const Answer answer = script_(*view);
    if (answer.failure) {
      waited_ += timeout;
      return tl::unexpected(*answer.failure);
    }
    const auto id = view->request_id + static_cast<std::uint32_t>(answer.id_offset);
    return protocol::encode_reply(answer.status, id, answer.payload, reply) - answer.cut;
  }
  Result<void> start_stream(device::TransferSink&, std::size_t) override { return {}; }
  void stop_stream() override {}

  /// For answers that never came, had this been a bus.
  [[nodiscard]] std::chrono::milliseconds waited() const { return waited_; }

 private:
  Script script_;
  std::chrono::milliseconds waited_{0};
};

template <class T>
std::vector<std::byte> payload_of(const T& message) {
  const auto bytes = protocol::bytes_of(message);
  return {bytes.begin(), bytes.end()};
}

}  // namespace sonoloft::test
