#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/command.h"

// request -> [REPLAYED PROBE] -> reply

namespace sonoloft::record {

/// How a replay answers requests: as the probe did when it was recorded, as far as it says what it is; as things are
/// now in everything else. Threads: one at a time.
class ReplayedProbe {
 public:
  /// `info`, `calibration`: payloads of the recorded replies to GET_INFO and GET_CALIBRATION
  ReplayedProbe(std::vector<std::byte> info, std::vector<std::byte> calibration);

  /// @pre reply.size() >= protocol::kMaxRequestLen @return the reply's length
  [[nodiscard]] std::size_t answer(std::span<const std::byte> request, std::span<std::byte> reply);

  /// The session that was asked for; nothing before a START and after a STOP.
  [[nodiscard]] std::optional<std::uint32_t> session_id() const { return session_id_; }
  /// All of this session was sent.
  void end() { ended_ = true; }

  /// A record is about to be sent: one of the recorded session becomes one of the present session and is counted, all
  /// else stays as it is. @pre session_id()
  void adopt(std::span<std::byte> record, std::uint32_t recorded_id);
  /// The same of an event. @pre session_id()
  void adopt_event(std::span<std::byte> event, std::uint32_t recorded_id) const;

 private:
  std::size_t reply_ok(std::uint32_t request_id, std::span<const std::byte> payload, std::span<std::byte> reply) const;

  std::vector<std::byte> info_, calibration_;
  std::optional<std::uint32_t> session_id_;
  bool ended_ = false;
  protocol::StatsReply stats_{};
};

}  // namespace sonoloft::record
