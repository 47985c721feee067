#pragma once
#include <cstdint>
#include <optional>

#include "protocol/command.h"

namespace sonoloft::device {

/// Where every record of a run went. Sequence numbers start at 0 with every run. At its end
///   made == delivered + host_dropped + crc_bad + malformed + transport_lost + device_dropped,
/// where every term but transport_lost is counted where it happens, and transport_lost is what remains.
struct Ledger {
  std::uint64_t made = 0;            ///< last_seq - first_seq + 1, as far as the host knows
  std::uint64_t delivered = 0;       ///< handed to the slice callback
  std::uint64_t host_dropped = 0;    ///< sound, but the callback was too slow or the run ended
  std::uint64_t crc_bad = 0;         ///< altered on the way
  std::uint64_t malformed = 0;       ///< rejected for another reason
  std::uint64_t transport_lost = 0;  ///< sent, never received
  std::uint64_t device_dropped = 0;  ///< the device's ring was full, or the run ended with records in it
  std::uint64_t foreign = 0;         ///< outside of the sum: records of another session, or seen before
  /// The run has ended and the equation holds against the device's own count; with the device gone: up to the last
  /// record that came.
  bool closed = false;

  bool operator==(const Ledger&) const = default;
};

/// Keeps the ledger of one run. Threads: one at a time.
class Books {
 public:
  /// A sound record. @return false where it was seen before: it counts as foreign
  [[nodiscard]] bool receive(std::uint64_t seq, std::uint32_t device_dropped_total);
  void receive_crc_bad();
  void receive_malformed();
  void receive_foreign() { ++ledger_.foreign; }
  void deliver() { ++ledger_.delivered; }
  void drop_on_host(std::uint64_t count) { ledger_.host_dropped += count; }

  /// Ends the run. `stats`: what the device says after STOP; empty when it is gone.
  /// @pre every record received soundly was delivered or dropped
  void close(const std::optional<protocol::StatsReply>& stats);

  /// Records that the device made, as far as was seen.
  [[nodiscard]] std::uint64_t seen() const { return next_seq_ + bad_since_; }
  /// Up to date at any time; until close() transport_lost takes in what is on its way.
  [[nodiscard]] Ledger ledger() const;

 private:
  [[nodiscard]] std::uint64_t accounted() const;

  Ledger ledger_;
  bool ended_ = false;
  std::uint64_t received_ = 0;
  std::uint64_t next_seq_ = 0;   ///< after the newest sound record
  std::uint64_t bad_since_ = 0;  ///< unreadable records since then: they had numbers, too
};

}  // namespace sonoloft::device
