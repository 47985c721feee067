#include "core/methods/stack/signed_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/slice/section_raster.h"

namespace sonoloft {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;
/// Nodes around a segment that are told of it; the others hear of it from these.
constexpr int kReach = 2;

/// The nearest segment of every node.
class NearestSegments {
 public:
  struct Segment {
    Eigen::Vector2f a, step;
    float inverse_length2;
  };

  explicit NearestSegments(const PlaneGrid& grid)
      : grid_(grid), nearest_(grid.size(), kNone), distance2_(grid.size(), std::numeric_limits<float>::infinity()) {}

  void add(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm) {
    const Eigen::Vector2d a = to_grid(a_mm), b = to_grid(b_mm);
    const double length2 = (b - a).squaredNorm();
    if (length2 == 0) return;
    segments_.push_back({a.cast<float>(), (b - a).cast<float>(), static_cast<float>(1 / length2)});
    const auto segment = static_cast<std::uint32_t>(segments_.size() - 1);
    const Eigen::Vector2i low = (a.cwiseMin(b).array().floor().cast<int>() - kReach).cwiseMax(0),
                          high = (a.cwiseMax(b).array().ceil().cast<int>() + kReach)
                                     .cwiseMin(Eigen::Array2i(grid_.width - 1, grid_.height - 1));
    for (int y = low.y(); y <= high.y(); ++y)
      for (int x = low.x(); x <= high.x(); ++x) offer(grid_.index(x, y), {x, y}, segment);
  }

  /// Tells every node of the segments that its neighbours know, until all have heard of theirs.
  void spread() {
    for (int round = 0; round < 2; ++round) {
      for (int y = 0; y < grid_.height; ++y) {
        for (int x = 0; x < grid_.width; ++x) ask(x, y, {{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}});
        for (int x = grid_.width - 1; x >= 0; --x) ask(x, y, {{{1, 0}, {1, -1}, {0, -1}, {-1, -1}}});
      }
      for (int y = grid_.height - 1; y >= 0; --y) {
        for (int x = 0; x < grid_.width; ++x) ask(x, y, {{{-1, 0}, {-1, 1}, {0, 1}, {1, 1}}});
        for (int x = grid_.width - 1; x >= 0; --x) ask(x, y, {{{1, 0}, {1, 1}, {0, 1}, {-1, 1}}});
      }
    }
  }

  [[nodiscard]] bool empty() const { return segments_.empty(); }
  [[nodiscard]] float distance_mm(std::size_t node) const {
    return static_cast<float>(grid_.spacing_mm) * std::sqrt(distance2_[node]);
  }

 private:
  [[nodiscard]] Eigen::Vector2d to_grid(const Eigen::Vector2d& mm) const {
    return (mm / grid_.spacing_mm - grid_.first.cast<double>()).array() - 0.5;
  }
  void offer(std::size_t node, const Eigen::Vector2i& at, std::uint32_t segment) {
    const Segment& s = segments_[segment];
    const Eigen::Vector2f from_a = at.cast<float>() - s.a;
    const float along = std::clamp(from_a.dot(s.step) * s.inverse_length2, 0.0F, 1.0F);
    const float distance2 = (from_a - along * s.step).squaredNorm();
    if (distance2 >= distance2_[node]) return;
    distance2_[node] = distance2;
    nearest_[node] = segment;
  }
  void ask(int x, int y, const std::array<std::array<int, 2>, 4>& neighbours) {
    const std::size_t node = grid_.index(x, y);
    for (const auto& [dx, dy] : neighbours) {
      if (x + dx < 0 || x + dx >= grid_.width || y + dy < 0 || y + dy >= grid_.height) continue;
      const std::uint32_t segment = nearest_[grid_.index(x + dx, y + dy)];
      if (segment != kNone && segment != nearest_[node]) offer(node, {x, y}, segment);
    }
  }

  const PlaneGrid& grid_;
  std::vector<Segment> segments_;  ///< in steps of the grid from its first node
  std::vector<std::uint32_t> nearest_;
  std::vector<float> distance2_;
};

/// The section's labels at the nodes; outside where the raster does not reach.
std::vector<Label> labels_on(Section section, const PlaneGrid& grid) {
  std::vector<Label> labels(grid.size(), kOutside);
  const Eigen::Vector2d low = grid.point(-1, -1), high = grid.point(grid.width, grid.height);
  section.image_to_reference = Eigen::Isometry3d::Identity();
  const SectionRaster raster = rasterize(
      section, grid.spacing_mm, {Eigen::Vector3d(low.x(), low.y(), -1), Eigen::Vector3d(high.x(), high.y(), 1)});
  const Eigen::Vector2i shift = raster.first.cast<int>() - grid.first;
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      const Eigen::Vector2i at = shift + Eigen::Vector2i(x, y);
      if (raster.at(x, y) != kUnknown && at.minCoeff() >= 0 && at.x() < grid.width && at.y() < grid.height)
        labels[grid.index(at.x(), at.y())] = raster.at(x, y);
    }
  return labels;
}

}  // namespace

std::vector<float> signed_distance(const Section& section, const std::function<bool(Label)>& is_inside,
                                   const PlaneGrid& grid, float nowhere_mm) {
  NearestSegments nearest(grid);
  for (const SectionEdge& e : section.edges)
    if (is_inside(e.left) != is_inside(e.right)) nearest.add(section.points[e.a], section.points[e.b]);
  if (nearest.empty()) return std::vector<float>(grid.size(), nowhere_mm);
  nearest.spread();
  const std::vector<Label> labels = labels_on(section, grid);
  std::vector<float> distance_mm(grid.size());
  for (std::size_t node = 0; node < grid.size(); ++node)
    distance_mm[node] = is_inside(labels[node]) ? nearest.distance_mm(node) : -nearest.distance_mm(node);
  return distance_mm;
}

}  // namespace sonoloft
