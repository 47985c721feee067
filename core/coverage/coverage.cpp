#include "core/coverage/coverage.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/background/background.h"
#include "core/slice/section.h"

namespace sonoloft {
namespace {

constexpr double kGridSpacings = 2;  ///< of the background; also what is near
constexpr int kDirections = 100;
constexpr int kOffsets = 9;

/// Directions of half the sphere, evenly: a Fibonacci spiral.
std::vector<Eigen::Vector3d> half_sphere() {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections, r = std::sqrt(1 - z * z);
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

/// The hull of points as slabs, one for each direction.
class Hull {
 public:
  explicit Hull(std::vector<Eigen::Vector3d> directions)
      : directions_(std::move(directions)),
        low_(directions_.size(), std::numeric_limits<double>::infinity()),
        high_(directions_.size(), -std::numeric_limits<double>::infinity()) {}

  void add(const Eigen::Vector3d& p) {
    box_.extend(p);
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      const double height = directions_[i].dot(p);
      low_[i] = std::min(low_[i], height);
      high_[i] = std::max(high_[i], height);
    }
  }
  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const {
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      const double height = directions_[i].dot(p);
      if (height < low_[i] || height > high_[i]) return false;
    }
    return true;
  }
  [[nodiscard]] const Eigen::AlignedBox3d& box() const { return box_; }

 private:
  std::vector<Eigen::Vector3d> directions_;
  std::vector<double> low_, high_;
  Eigen::AlignedBox3d box_;
};

Hull hull_of_materials(const std::vector<const Section*>& sections) {
  const auto material = [](Label label) { return label != kOutside && label != kUnknown; };
  Hull hull(half_sphere());
  for (const Section* section : sections)
    for (const SectionEdge& edge : section->edges) {
      if (!material(edge.left) && !material(edge.right)) continue;
      for (const std::uint32_t end : {edge.a, edge.b}) {
        const Eigen::Vector2d& p = section->points[end];
        hull.add(section->image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0));
      }
    }
  return hull;
}

/// Points of the hull on a grid, and how far each is from what was seen.
struct Grid {
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  double step_mm = 1;
  std::vector<Eigen::Vector3d> point_mm;  ///< [#inside]
  std::vector<float> distance_mm;         ///< [#inside]
  std::vector<std::uint32_t> inside_of;   ///< [grid] index in point_mm, kOut
  std::vector<std::uint32_t> grid_of;     ///< [#inside]
  static constexpr std::uint32_t kOut = 0xFFFFFFFF;
};

Grid sample(const Hull& hull, const Background& background) {
  Grid grid;
  grid.step_mm = kGridSpacings * background.spacing_mm();
  if (hull.box().isEmpty()) return grid;
  grid.size = (hull.box().sizes() / grid.step_mm).array().floor().cast<int>() + 1;
  grid.inside_of.assign(static_cast<std::size_t>(grid.size.prod()), Grid::kOut);
  for (std::uint32_t i = 0; i < grid.inside_of.size(); ++i) {
    const auto n = static_cast<int>(i);
    const Eigen::Vector3i at(n % grid.size.x(), n / grid.size.x() % grid.size.y(), n / (grid.size.x() * grid.size.y()));
    const Eigen::Vector3d p = hull.box().min() + grid.step_mm * at.cast<double>();
    if (!hull.contains(p)) continue;
    grid.inside_of[i] = static_cast<std::uint32_t>(grid.point_mm.size());
    grid.point_mm.push_back(p);
    grid.grid_of.push_back(i);
  }
  background.distance(grid.point_mm, grid.distance_mm);
  return grid;
}

/// The largest set of points farther than `near_mm`, joined by neighbours in x, y, z. Indices in Grid::point_mm.
std::vector<std::uint32_t> largest_gap(const Grid& grid, double near_mm) {
  std::vector<std::uint32_t> largest;
  std::vector<bool> done(grid.point_mm.size(), false);
  const auto unseen = [&](std::uint32_t i) { return static_cast<double>(grid.distance_mm[i]) > near_mm; };
  const int stride[3] = {1, grid.size.x(), grid.size.x() * grid.size.y()};
  for (std::uint32_t start = 0; start < done.size(); ++start) {
    if (done[start] || !unseen(start)) continue;
    done[start] = true;
    std::vector<std::uint32_t> gap{start};
    for (std::size_t n = 0; n < gap.size(); ++n) {
      const auto at = static_cast<int>(grid.grid_of[gap[n]]);
      for (int axis = 0; axis < 3; ++axis) {
        const int along = at / stride[axis] % grid.size[axis];
        for (const int step : {-1, 1}) {
          if (along + step < 0 || along + step >= grid.size[axis]) continue;
          const std::uint32_t next = grid.inside_of[static_cast<std::size_t>(at + step * stride[axis])];
          if (next == Grid::kOut || done[next] || !unseen(next)) continue;
          done[next] = true;
          gap.push_back(next);
        }
      }
    }
    if (gap.size() > largest.size()) largest = std::move(gap);
  }
  return largest;
}

/// Of planes in all directions at offsets throughout the gap, that which takes most from the distances in it.
Eigen::Isometry3d best_plane(const Grid& grid, const std::vector<std::uint32_t>& gap,
                             const Eigen::Vector3d& centre_mm) {
  double best_gain = -1, best_offset = 0;
  Eigen::Vector3d best_normal = Eigen::Vector3d::UnitZ();
  std::vector<double> height(gap.size());
  for (const Eigen::Vector3d& normal : half_sphere()) {
    for (std::size_t i = 0; i < gap.size(); ++i) height[i] = normal.dot(grid.point_mm[gap[i]] - centre_mm);
    const auto [low, high] = std::minmax_element(height.begin(), height.end());
    for (int o = 0; o < kOffsets; ++o) {
      const double offset = *low + (*high - *low) * (o + 0.5) / kOffsets;
      double gain = 0;
      for (std::size_t i = 0; i < gap.size(); ++i)
        gain += std::max(0.0, static_cast<double>(grid.distance_mm[gap[i]]) - std::abs(height[i] - offset));
      if (gain <= best_gain) continue;
      best_gain = gain;
      best_normal = normal;
      best_offset = offset;
    }
  }
  Eigen::Isometry3d plane = Eigen::Isometry3d::Identity();
  plane.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), best_normal).toRotationMatrix();
  plane.translation() = centre_mm + best_offset * best_normal;
  return plane;
}

}  // namespace

Coverage coverage_of(const std::vector<const Section*>& sections, const Background& background) {
  const Grid grid = sample(hull_of_materials(sections), background);
  const double near_mm = grid.step_mm, point_mm3 = std::pow(grid.step_mm, 3);
  Coverage coverage;
  coverage.near_mm = near_mm;
  coverage.volume_mm3 = point_mm3 * static_cast<double>(grid.point_mm.size());
  for (const float distance : grid.distance_mm)
    if (static_cast<double>(distance) <= near_mm) coverage.seen_mm3 += point_mm3;
  const std::vector<std::uint32_t> points = largest_gap(grid, near_mm);
  if (points.empty()) return coverage;
  CoverageGap& gap = coverage.largest_gap.emplace();
  gap.volume_mm3 = point_mm3 * static_cast<double>(points.size());
  for (const std::uint32_t i : points) {
    gap.centre_mm += grid.point_mm[i] / static_cast<double>(points.size());
    gap.deepest_mm = std::max(gap.deepest_mm, static_cast<double>(grid.distance_mm[i]));
  }
  gap.suggested_image_to_reference = best_plane(grid, points, gap.centre_mm);
  return coverage;
}

}  // namespace sonoloft
