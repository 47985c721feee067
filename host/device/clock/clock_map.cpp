#include "host/device/clock/clock_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sonoloft::device {
namespace {

constexpr std::int64_t kWindowNs = 60'000'000'000;
constexpr std::size_t kWindowExchanges = 256;
constexpr std::size_t kPieces = 16;
constexpr std::int64_t kSetNs = 5'000'000;  // what no drift explains
constexpr std::int64_t kHorizonNs = 10'000'000'000;
constexpr double kSlew = 1e-3;
constexpr double kLargestDrift = 1e-2;
constexpr double kExpectedDrift = 2e-4;  // of crystals, one sigma: steadies the line while it is short

// Clocks wrap: only differences mean something.
std::int64_t difference(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::int64_t>(a - b);
}

std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

bool quicker(const TimeExchange& a, const TimeExchange& b) {
  return a.round_trip_ns() < b.round_trip_ns();
}

}  // namespace

double ClockMap::Piece::left_of_error_ns(std::uint64_t device_ns) const {
  const double worked_off = kSlew * static_cast<double>(std::max<std::int64_t>(difference(device_ns, from), 0));
  return std::copysign(std::max(std::abs(error_ns) - worked_off, 0.0), error_ns);
}

std::int64_t ClockMap::Piece::at(std::uint64_t device_ns) const {
  const std::int64_t d = difference(device_ns, from);
  const std::int64_t correction = std::llround(drift * static_cast<double>(d) + left_of_error_ns(device_ns));
  return sum(host_ns, sum(d, correction));
}

bool ClockMap::add(std::span<const TimeExchange> burst) {
  if (burst.empty()) return false;
  const TimeExchange quickest = *std::min_element(burst.begin(), burst.end(), quicker);
  const bool set = !pieces_.empty() && contradicts(quickest);
  if (set) {
    window_.clear();
    pieces_.clear();
  }
  window_.push_back(quickest);
  forget_old();
  std::vector<TimeExchange> sorted(window_.begin(), window_.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end(), quicker);
  usual_round_trip_ns_ = middle->round_trip_ns();
  continue_with(fit());
  return set;
}

bool ClockMap::contradicts(const TimeExchange& quickest) const {
  const auto expected = static_cast<double>(pieces_.back().at(quickest.device_ns));
  const auto limit = static_cast<double>(quickest.round_trip_ns() + kSetNs);
  return std::abs(expected - static_cast<double>(quickest.middle_ns())) > limit;
}

void ClockMap::forget_old() {
  const std::uint64_t newest = window_.back().device_ns;
  while (window_.size() > kWindowExchanges || difference(newest, window_.front().device_ns) > kWindowNs) {
    window_.pop_front();
  }
}

ClockMap::Piece ClockMap::fit() const {
  const TimeExchange& origin = window_.back();
  double weights = 0, mean_x = 0, mean_y = 0, sxx = 1 / (kExpectedDrift * kExpectedDrift), sxy = 0;
  for (const TimeExchange& e : window_) {
    if (!counts(e)) continue;
    const std::int64_t device = difference(e.device_ns, origin.device_ns);
    const auto x = static_cast<double>(device);
    const auto y = static_cast<double>(e.middle_ns() - origin.middle_ns() - device);
    // The middle is off by a quarter of the round trip or so, one sigma.
    const double sigma = static_cast<double>(e.round_trip_ns()) / 4 + 1;
    const double weight = 1 / (sigma * sigma), dx = x - mean_x;
    weights += weight;
    mean_x += dx * weight / weights;
    mean_y += (y - mean_y) * weight / weights;
    sxx += weight * dx * (x - mean_x);
    sxy += weight * dx * (y - mean_y);
  }
  const double drift = std::clamp(sxy / sxx, -kLargestDrift, kLargestDrift);
  // Where requests and replies do not take equally long, middles are off by up to half of the round trip: two sigma.
  Piece line{origin.device_ns, origin.middle_ns() + std::llround(mean_y - drift * mean_x), drift, 2 / std::sqrt(sxx)};
  find_surest(line);
  return line;
}

// At an exchange the line is off the truth by at most half the round trip and its own distance from the middle.
void ClockMap::find_surest(Piece& line) const {
  double best = std::numeric_limits<double>::infinity();
  for (const TimeExchange& e : window_) {
    if (!counts(e)) continue;
    const auto off = static_cast<double>(std::abs(line.at(e.device_ns) - e.middle_ns()));
    const double here = static_cast<double>(e.round_trip_ns()) / 2 + off;
    const auto age = static_cast<double>(difference(line.from, e.device_ns));
    if (here + 3 * line.drift_sigma * age >= best) continue;
    best = here + 3 * line.drift_sigma * age;
    line.surest = e.device_ns;
    line.uncertainty_ns = here;
  }
}

void ClockMap::continue_with(Piece line) {
  std::uint64_t from = line.from;
  if (!pieces_.empty() && difference(newest_mapped_, from) > 0) from = newest_mapped_;
  line.host_ns = line.at(from);
  line.from = from;
  if (!pieces_.empty()) {
    line.error_ns = static_cast<double>(piece_of(from).at(from) - line.host_ns);
  } else {
    newest_mapped_ = from;
    if (last_output_ns_)
      line.error_ns = static_cast<double>(std::max<std::int64_t>(*last_output_ns_ - line.host_ns, 0));
  }
  pieces_.push_back(line);
  if (pieces_.size() > kPieces) pieces_.pop_front();
}

const ClockMap::Piece& ClockMap::piece_of(std::uint64_t device_ns) const {
  const auto later = [&](const Piece& piece) { return difference(device_ns, piece.from) < 0; };
  const auto found = std::find_if_not(pieces_.rbegin(), pieces_.rend(), later);
  return found == pieces_.rend() ? pieces_.front() : *found;
}

std::optional<HostTime> ClockMap::at(std::uint64_t device_ns) {
  if (pieces_.empty()) return std::nullopt;
  const Piece& piece = piece_of(device_ns);
  const std::int64_t host_ns = piece.at(device_ns);
  const std::int64_t past_exchange = difference(device_ns, window_.back().device_ns);
  if (past_exchange <= kHorizonNs && past_exchange >= -kWindowNs) {  // a time from nowhere must not hold lines back
    if (difference(device_ns, newest_mapped_) > 0) newest_mapped_ = device_ns;
    last_output_ns_ = std::max(last_output_ns_.value_or(host_ns), host_ns);
  }
  const auto distance = std::abs(static_cast<double>(difference(device_ns, piece.surest)));
  const double uncertainty_ns =
      piece.uncertainty_ns + std::abs(piece.left_of_error_ns(device_ns)) + 3 * piece.drift_sigma * distance;
  return HostTime{std::chrono::steady_clock::time_point(std::chrono::nanoseconds(host_ns)),
                  std::chrono::nanoseconds(std::llround(uncertainty_ns))};
}

}  // namespace sonoloft::device
