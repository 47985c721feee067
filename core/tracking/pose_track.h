#pragma once
#include <Eigen/Geometry>
#include <chrono>
#include <deque>
#include <optional>

namespace sonoloft {

/// What a tracker measured over time, and the pose in between: rotation by spherical, translation by linear
/// interpolation (Shoemake 1985). Nothing is invented: between two poses that are more than `longest_gap` apart, or
/// next to one that was not ok, there is none. Frames: any, as the poses given; times of one clock. Threads: one at a
/// time.
class PoseTrack {
 public:
  using Time = std::chrono::nanoseconds;

  explicit PoseTrack(Time longest_gap = std::chrono::milliseconds(250)) : longest_gap_(longest_gap) {}

  /// What was measured at a time; nothing: the tracker had no usable pose then. Of times that do not increase the first
  /// counts.
  void add(Time time, std::optional<Eigen::Isometry3d> pose);

  /// @cost O(log poses)
  [[nodiscard]] std::optional<Eigen::Isometry3d> at(Time time) const;

  /// When was measured last, ok or not; nothing before the first time.
  [[nodiscard]] std::optional<Time> newest() const;
  /// Forgets what no time from `time` on needs.
  void forget_before(Time time);

 private:
  struct Sample {
    Time time;
    std::optional<Eigen::Isometry3d> pose;
  };

  Time longest_gap_;
  std::deque<Sample> samples_;
};

}  // namespace sonoloft
