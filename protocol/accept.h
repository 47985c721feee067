#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/record.h"
#include "protocol/slice.h"
#include "protocol/slice_codec.h"

// bus -> transfer -> [ACCEPT] -> slice

namespace sonoloft::protocol {

/// Why a transfer was not accepted: the first check that it failed, in the order in which they are made. Nothing of a
/// record is used before the check that covers it.
enum class Reject : std::uint8_t {
  none,
  length,       ///< shorter than a header and a trailer, or longer than the negotiated max_record
  magic,        ///< does not begin like a record
  header_crc,   ///< the header was altered on the way
  version,      ///< another major, a newer minor, another schema or an unknown incompatible feature
  lengths,      ///< header_len, payload_len, total_len and the transfer disagree
  session,      ///< of another session, type or stream than was started
  trailer,      ///< no trailer, of another record, or marked as spoiled by the device
  payload_crc,  ///< the payload was altered on the way
  alignment,    ///< the payload does not start on 16 bytes in memory
  verifier,     ///< no FlatBuffer of the schema
  meaning,      ///< breaks a rule of check_slice()
};
inline constexpr std::size_t kRejectCount = 12;

/// The name of a reason as written above. Never fails.
[[nodiscard]] const char* name(Reject reason);

/// What both ends agreed on before the stream began.
struct Agreement {
  std::uint8_t minor = 0;
  std::uint32_t schema_hash = 0;
  std::uint32_t session_id = 0;
  std::uint32_t max_record = 0;  ///< bytes
  SliceLimits limits;
};

/// A record that passed every check. The views of `slice` point into the transfer's bytes.
struct AcceptedSlice {
  RecordHeader header;
  Slice slice;
};

/// Checks transfers one by one and counts what became of them. Threads: one at a time.
class Acceptor {
 public:
  explicit Acceptor(const Agreement& agreement) : agreement_(agreement) {}

  /// @post  `accepted` is filled where the answer is Reject::none, else untouched
  /// @error any bytes whatever: a reason, never a crash
  /// @cost  O(bytes), one pass; no heap
  [[nodiscard]] Reject accept(std::span<const std::byte> transfer, AcceptedSlice& accepted);

  /// How many transfers ended with `reason`; Reject::none counts the accepted ones.
  [[nodiscard]] std::uint64_t count(Reject reason) const { return counts_[static_cast<std::size_t>(reason)]; }

 private:
  [[nodiscard]] Reject check(std::span<const std::byte> transfer, AcceptedSlice& accepted) const;

  Agreement agreement_;
  std::array<std::uint64_t, kRejectCount> counts_{};
};

}  // namespace sonoloft::protocol
