#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>

namespace sonoloft::device_sim {

/// What can happen to what travels over a cable, and to the ends of it.
enum class FaultKind : std::uint8_t {
  none,
  drop,                ///< a record is lost
  duplicate,           ///< a record comes twice
  swap,                ///< a record comes after its successor
  stale,               ///< a record of an earlier session comes, too
  truncate,            ///< a record ends too early, at any byte
  extend,              ///< a record goes on with bytes from nowhere
  flip,                ///< bits of a record change, anywhere in it
  delay,               ///< a record comes late
  stall,               ///< nothing comes for a while
  nak_for_ever,        ///< nothing comes any more; requests are still answered
  halt,                ///< the stream is halted until somebody clears it; the record is lost
  disconnect,          ///< the cable is pulled within a record
  freeze,              ///< the device answers nothing any more
  reset,               ///< the device starts anew within a record
  host_death,          ///< no request reaches the device any more, and nobody reads
  lose_request,        ///< a request never arrives
  lose_reply,          ///< a request is carried out, its reply is lost
  cut_reply,           ///< a reply ends too early
  disconnect_request,  ///< the cable is pulled within a request
  disconnect_reply,    ///< the cable is pulled within a reply
};
inline constexpr std::size_t kFaultKindCount = 21;

/// The name as written above. Never fails.
[[nodiscard]] const char* name(FaultKind kind);

/// Decides what happens when, and knows no bus: the same plan brings about the same faults under every port.
/// Threads: one at a time.
class FaultPlan {
 public:
  /// One of `one_in` messages suffers, chosen by the seed; of the kinds that nothing follows, the `one_in`-th.
  /// @pre one_in >= 1
  FaultPlan(FaultKind kind, std::uint32_t seed, std::uint32_t one_in) : kind_(kind), one_in_(one_in), random_(seed) {}
  /// The `index`-th record or request (from 0) suffers, at the byte `offset`, and no other one.
  static FaultPlan once(FaultKind kind, std::uint64_t index, std::size_t offset);

  [[nodiscard]] FaultKind kind() const { return kind_; }
  /// Whether the next record, or the next request, suffers.
  [[nodiscard]] bool strikes_record();
  [[nodiscard]] bool strikes_request();
  /// Of a message of `size` bytes: where. @post < size, or 0
  [[nodiscard]] std::size_t offset(std::size_t size);
  /// A number of [low, high].
  [[nodiscard]] std::uint32_t amount(std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(random_() % (high - low + 1));
  }

 private:
  [[nodiscard]] bool strikes(std::uint64_t& count);

  FaultKind kind_;
  std::uint32_t one_in_;
  std::mt19937 random_;
  std::uint64_t records_ = 0, requests_ = 0;
  std::optional<std::uint64_t> only_;
  std::size_t offset_ = 0;
};

}  // namespace sonoloft::device_sim
