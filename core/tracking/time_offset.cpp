#include "core/tracking/time_offset.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace sonoloft {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr milliseconds kLargest{500};
constexpr std::size_t kLeastImages = 20;
constexpr double kLeastCorrelation = 0.9;
constexpr double kLeastMotionMm = 1;  // standard deviation

/// Where the probe was when the images were taken, were the offset this one. Those without a pose are left out.
struct Pairs {
  std::vector<Eigen::Vector3d> positions;
  std::vector<double> values;

  Pairs(std::span<const TimedValue> seen, const PoseTrack& track, nanoseconds offset) {
    for (const TimedValue& s : seen) {
      const auto pose = track.at(s.time + offset);
      if (!pose) continue;
      positions.push_back(pose->translation());
      values.push_back(s.value);
    }
  }
};

struct Direction {
  Eigen::Vector3d axis;
  double sigma_mm;
};

Direction main_direction(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : positions) mean += p / static_cast<double>(positions.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : positions)
    spread += (p - mean) * (p - mean).transpose() / static_cast<double>(positions.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  return {axes.eigenvectors().col(2), std::sqrt(std::max(axes.eigenvalues()[2], 0.0))};
}

/// The square of the correlation: which way the image counts does not matter. 0 for too few pairs.
double correlation(const Pairs& pairs, const Eigen::Vector3d& axis) {
  if (pairs.values.size() < kLeastImages) return 0;
  const auto count = static_cast<Eigen::Index>(pairs.values.size());
  Eigen::VectorXd way(count);
  for (Eigen::Index i = 0; i < count; ++i) way[i] = pairs.positions[static_cast<std::size_t>(i)].dot(axis);
  Eigen::VectorXd seen = Eigen::Map<const Eigen::VectorXd>(pairs.values.data(), count);
  way.array() -= way.mean();
  seen.array() -= seen.mean();
  const double norms = way.squaredNorm() * seen.squaredNorm();
  return norms > 0 ? way.dot(seen) * way.dot(seen) / norms : 0;
}

}  // namespace

Result<TimeOffset> estimate_time_offset(std::span<const TimedValue> seen, const PoseTrack& track) {
  const Pairs unshifted(seen, track, nanoseconds(0));
  if (unshifted.values.size() < kLeastImages)
    return fail(ErrorCode::empty_input, "only " + std::to_string(unshifted.values.size()) +
                                            " images have poses around them: record at least 20 of both together");
  const Direction direction = main_direction(unshifted.positions);
  if (direction.sigma_mm < kLeastMotionMm)
    return fail(ErrorCode::invalid_argument, "the probe rested: move it back and forth while you record");

  std::vector<double> correlations;
  for (milliseconds offset = -kLargest; offset <= kLargest; ++offset)
    correlations.push_back(correlation(Pairs(seen, track, offset), direction.axis));
  const auto best = std::max_element(correlations.begin(), correlations.end());
  if (std::sqrt(*best) < kLeastCorrelation)
    return fail(ErrorCode::invalid_argument, "what the images show does not move as the probe does (correlation " +
                                                 std::to_string(std::sqrt(*best)) +
                                                 "): move it along one line towards a flat bottom");
  double refined = 0;  // the top of the parabola through the best and its neighbours, in steps
  if (best != correlations.begin() && best + 1 != correlations.end()) {
    const double bend = best[-1] - 2 * best[0] + best[1];
    if (bend < 0) refined = 0.5 * (best[-1] - best[1]) / bend;
  }
  const double offset_ms =
      static_cast<double>(best - correlations.begin()) + refined - static_cast<double>(kLargest.count());
  return TimeOffset{nanoseconds(std::llround(offset_ms * 1e6)), std::sqrt(*best)};
}

}  // namespace sonoloft
