#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

// device time -> [CLOCK MAP] -> host time;  TIME_SYNC exchanges keep it right

namespace sonoloft::device {

/// One TIME_SYNC. Host times are of the steady clock, in ns since its epoch; the device's clock starts anywhere and may
/// wrap at 2^64.
struct TimeExchange {
  std::int64_t sent_ns;      ///< host clock, before the request left
  std::uint64_t device_ns;   ///< device clock, when it read the request
  std::int64_t received_ns;  ///< host clock, after the reply came

  [[nodiscard]] std::int64_t round_trip_ns() const { return received_ns - sent_ns; }
  [[nodiscard]] std::int64_t middle_ns() const { return sent_ns + round_trip_ns() / 2; }
};

/// A time of the device's clock, mapped to the host's steady clock.
struct HostTime {
  std::chrono::steady_clock::time_point time;
  /// The truth is nearer than this, with three sigma of the drift, while the device's clock runs evenly.
  std::chrono::nanoseconds uncertainty;
};

/// Maps the device's clock to the host's: a straight line through the middles of exchanges of the last minute. Of each
/// burst the quickest counts (as in Mills' clock filter, RFC 5905, section 10), unless it took more than twice the
/// usual one; the quicker, the more. A new line is approached by at most 1 ms a second, so that what is mapped never
/// runs backwards. Threads: one at a time.
class ClockMap {
 public:
  /// Takes the exchanges of a burst. Where even the quickest of them contradicts the line by more than its round trip
  /// and 5 ms, one of the clocks was set: all before is forgotten, and the line is as unsure as
  /// at the beginning. @return whether that was so
  /// @cost O(bursts of the last minute), at most 256
  bool add(std::span<const TimeExchange> burst);

  /// Nothing before the first burst. Continuous and monotone over all calls and bursts, for device times up to 10 s
  /// after the last exchange; across a clock that was set it still never runs backwards.
  [[nodiscard]] std::optional<HostTime> at(std::uint64_t device_ns);

  /// How much faster the host's clock runs, 1e-6.
  [[nodiscard]] double drift_ppm() const { return pieces_.empty() ? 0 : pieces_.back().drift * 1e6; }
  /// The usual round trip of the quickest of a burst: their median.
  [[nodiscard]] std::chrono::nanoseconds round_trip() const { return std::chrono::nanoseconds(usual_round_trip_ns_); }

 private:
  // host = host_ns + d + drift * d + what is left of error, d = device - from, for device times from `from` on
  struct Piece {
    std::uint64_t from = 0;
    std::int64_t host_ns = 0;
    double drift = 0;
    double drift_sigma = 0;     ///< of the fit
    std::uint64_t surest = 0;   ///< where the line is known best
    double uncertainty_ns = 0;  ///< there
    double error_ns = 0;        ///< at `from`, of the output against the line

    [[nodiscard]] double left_of_error_ns(std::uint64_t device_ns) const;
    [[nodiscard]] std::int64_t at(std::uint64_t device_ns) const;
  };

  [[nodiscard]] bool contradicts(const TimeExchange& quickest) const;
  void forget_old();
  [[nodiscard]] Piece fit() const;
  void find_surest(Piece& line) const;
  [[nodiscard]] const Piece& piece_of(std::uint64_t device_ns) const;
  void continue_with(Piece line);

  [[nodiscard]] bool counts(const TimeExchange& e) const { return e.round_trip_ns() <= 2 * usual_round_trip_ns_; }

  std::deque<TimeExchange> window_;  ///< the quickest of each burst
  std::int64_t usual_round_trip_ns_ = 0;
  std::deque<Piece> pieces_;  ///< the last few: times are mapped late
  std::uint64_t newest_mapped_ = 0;
  std::optional<std::int64_t> last_output_ns_;  ///< the latest
};

}  // namespace sonoloft::device
