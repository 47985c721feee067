#pragma once
// slices -> [PROBE PATH] -> page
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sonoloft::view {

/// Where the probe was: a line that never has more than kMaxPoints points. When it is full every other one goes, and
/// the line gets a new epoch, by which viewers see that they have to start again. Threads: the server's.
class ProbePath {
 public:
  static constexpr std::size_t kMaxPoints = 4096;

  struct Seen {
    std::uint64_t epoch = 0;
    std::size_t points = 0;  ///< of that epoch
  };

  void add(std::span<const Eigen::Vector3f> steps) {
    for (const Eigen::Vector3f& p : steps) {
      if (points_.size() == kMaxPoints) halve();
      points_.push_back(p);
    }
  }

  /// What a viewer lacks; brings `seen` up to date. @return valid until the next add()
  std::span<const Eigen::Vector3f> newer(Seen& seen) const {
    const std::size_t from = seen.epoch == epoch_ ? seen.points : 0;
    seen = {epoch_, points_.size()};
    return std::span(points_).subspan(from);
  }

 private:
  void halve() {
    for (std::size_t i = 0; i < kMaxPoints / 2; ++i) points_[i] = points_[2 * i];
    points_.resize(kMaxPoints / 2);
    ++epoch_;
  }

  std::uint64_t epoch_ = 1;
  std::vector<Eigen::Vector3f> points_;
};

}  // namespace sonoloft::view
