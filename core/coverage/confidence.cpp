#include "core/coverage/confidence.h"

#include <array>

namespace sonoloft {
namespace {

/// The unmeasured share between the samples; samples that were not taken have no say.
class Unmeasured {
 public:
  explicit Unmeasured(const SampleLattice& samples) : samples_(samples) {}

  [[nodiscard]] float at(const Eigen::Vector3d& point_mm) {
    const Eigen::Vector3d p = (point_mm - samples_.origin_mm()) / samples_.spacing_mm();
    const Eigen::Vector3i low = p.array().floor().cast<int>();
    const Eigen::Vector3d t = p - low.cast<double>();
    double sum = 0, weight = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3i at = low + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
      const Brick* brick = find(at);
      const auto index = static_cast<std::size_t>(sample_index(at.x() & 7, at.y() & 7, at.z() & 7));
      if (brick == nullptr || brick->label[index] == kNotSampled) continue;
      double w = 1;
      for (int axis = 0; axis < 3; ++axis) w *= (corner >> axis & 1) != 0 ? t[axis] : 1 - t[axis];
      weight += w;
      if (!brick->unmeasured.empty()) sum += w * static_cast<double>(brick->unmeasured[index]);
    }
    return weight > 0 ? static_cast<float>(sum / weight) : 0.0f;
  }

 private:
  /// Vertices beside each other ask for the same bricks.
  const Brick* find(const Eigen::Vector3i& at) {
    const BrickCoord coord{at.x() >> 3, at.y() >> 3, at.z() >> 3};
    if (!(coord == last_)) {
      last_ = coord;
      brick_ = samples_.find(coord);
    }
    return brick_;
  }

  const SampleLattice& samples_;
  BrickCoord last_{INT32_MIN, 0, 0};
  const Brick* brick_ = nullptr;
};

}  // namespace

Confidence confidence_at(std::span<const Eigen::Vector3f> points_mm, const SampleLattice& samples,
                         const Background& background) {
  Confidence result;
  std::vector<Eigen::Vector3d> points;
  points.reserve(points_mm.size());
  Unmeasured unmeasured(samples);
  for (const Eigen::Vector3f& point : points_mm) {
    points.push_back(point.cast<double>());
    result.measured.push_back(1.0f - unmeasured.at(points.back()));
  }
  background.distance(points, result.distance_mm);
  return result;
}

}  // namespace sonoloft
