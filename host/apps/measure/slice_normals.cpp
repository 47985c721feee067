#include "host/apps/measure/slice_normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "host/apps/measure/mesh_tree.h"

namespace sonoloft {
namespace {

using Planes = std::vector<Eigen::Isometry3d>;  ///< reference to image

constexpr double kClearBands = 2;

bool clear_of_others(const Eigen::Vector3d& p, std::size_t own, const Planes& planes, double distance_mm) {
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (i != own && std::abs((planes[i] * p).z()) < distance_mm) return false;
  return true;
}

/// The stretches of one slice's contours, by their middles.
class Stretches {
 public:
  Stretches(std::span<const TrackedSlice> slices, std::size_t own, const Planes& planes, double band_mm)
      : band_mm_(band_mm) {
    const TrackedSlice& slice = slices[own];
    for (const Contour& contour : slice.contours) {
      double next = band_mm / 2;
      for (std::uint32_t i = 0; i < contour.count; ++i) {
        const Eigen::Vector2d& a = slice.points[contour.first + i];
        const Eigen::Vector2d along = slice.points[contour.first + (i + 1) % contour.count] - a;
        for (; next < along.norm(); next += band_mm) {
          const Eigen::Vector2d p = a + next / along.norm() * along;
          const Eigen::Vector3d in_space = slice.image_to_reference * Eigen::Vector3d(p.x(), p.y(), 0);
          if (clear_of_others(in_space, own, planes, kClearBands * band_mm))
            squares_[square(p)].push_back(middles_.size());
          middles_.push_back(p);
        }
        next -= along.norm();
      }
      middles_.emplace_back();  // no stretch: parts the numbers of two contours
    }
  }

  /// The one whose middle is nearest, within a band.
  [[nodiscard]] std::optional<std::size_t> nearest(const Eigen::Vector2d& p) const {
    std::optional<std::size_t> found;
    double least = band_mm_ * band_mm_;
    const auto [x, y] = square(p);
    for (int k = 0; k < 9; ++k) {
      const auto it = squares_.find({x + k % 3 - 1, y + k / 3 - 1});
      if (it == squares_.end()) continue;
      for (const std::size_t i : it->second) {
        const double d2 = (middles_[i] - p).squaredNorm();
        if (d2 < least) least = d2, found = i;
      }
    }
    return found;
  }

 private:
  [[nodiscard]] std::pair<long, long> square(const Eigen::Vector2d& p) const {
    return {std::lround(p.x() / band_mm_), std::lround(p.y() / band_mm_)};
  }

  double band_mm_;
  std::vector<Eigen::Vector2d> middles_;
  std::map<std::pair<long, long>, std::vector<std::size_t>> squares_;
};

using Sides = SliceNormals::mapped_type;
using Triangle = std::array<Eigen::Vector3d, 3>;

/// The middles of equal parts of a triangle, none of which is longer than a third of a band.
template <class Visit>
void for_each_part(const Triangle& t, double band_mm, Visit visit) {
  const double longest = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
  const int n = std::max(1, static_cast<int>(std::ceil(3 * longest / band_mm)));
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j)
      for (int upper = 0; upper <= (i + j + 1 < n ? 1 : 0); ++upper) {
        const double u = (i + (1 + upper) / 3.0) / n, v = (j + (1 + upper) / 3.0) / n;
        visit(Eigen::Vector3d(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0])), 1.0 / (n * n));
      }
}

bool out_of_reach(const Triangle& t, const Eigen::Isometry3d& plane, double band_mm) {
  const double a = (plane * t[0]).z(), b = (plane * t[1]).z(), c = (plane * t[2]).z();
  return std::min({a, b, c}) > band_mm || std::max({a, b, c}) < -band_mm;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

double mean_along_deg(const SliceNormals& normals) {
  double sum = 0, count = 0;
  for (const auto& [place, sides] : normals) {
    auto following = place;
    ++std::get<1>(following);
    const auto next = normals.find(following);
    if (next == normals.end()) continue;
    sum += angle_deg(sides[0] + sides[1], next->second[0] + next->second[1]);
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

/// @pre there is a value
std::array<double, 3> quartiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t last = values.size() - 1;
  return {values[last / 4], values[last / 2], values[3 * last / 4]};
}

}  // namespace

SliceNormals normals_at_slices(const IndexedMesh& mesh, std::span<const TrackedSlice> slices, double band_mm) {
  Planes planes;
  for (const TrackedSlice& slice : slices) planes.push_back(slice.image_to_reference.inverse());
  SliceNormals normals;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const Stretches stretches(slices, k, planes, band_mm);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = corners(mesh, i);
      if (out_of_reach(t, planes[k], band_mm)) continue;
      const auto labels = std::minmax({mesh.label_front[i], mesh.label_back[i]});
      const Eigen::Vector3d area = (t[1] - t[0]).cross(t[2] - t[0]) / (labels.first == mesh.label_front[i] ? 2 : -2);
      for_each_part(t, band_mm, [&](const Eigen::Vector3d& middle, double share) {
        const Eigen::Vector3d p = planes[k] * middle;
        const auto stretch = std::abs(p.z()) < band_mm ? stretches.nearest(p.head<2>()) : std::nullopt;
        if (!stretch) return;
        const auto place = normals.try_emplace({k, *stretch, labels.first, labels.second});
        if (place.second) place.first->second.fill(Eigen::Vector3d::Zero());
        place.first->second[p.z() > 0 ? 1 : 0] += share * area;
      });
    }
  }
  std::erase_if(normals, [](const auto& place) { return place.second[0].isZero(0) || place.second[1].isZero(0); });
  return normals;
}

SlicePassage compare_passage(const SliceNormals& mesh, const SliceNormals& truth) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const auto turn = [](const Sides& sides) { return Eigen::Vector3d(sides[1].normalized() - sides[0].normalized()); };
  SlicePassage sum;
  std::vector<double> turns;
  for (const auto& [place, sides] : mesh) {
    const auto found = truth.find(place);
    if (found == truth.end()) continue;
    const Sides& of_truth = found->second;
    turns.push_back(angle_deg(sides[0], sides[1]));
    sum.turn_deg += turns.back();
    sum.truth_turn_deg += angle_deg(of_truth[0], of_truth[1]);
    sum.crease_deg += kDegrees * (turn(sides) - turn(of_truth)).norm();
    sum.lean_deg += angle_deg(sides[0] + sides[1], of_truth[0] + of_truth[1]);
  }
  if (turns.empty()) return {};
  const auto places = static_cast<double>(turns.size());
  return {sum.turn_deg / places,       sum.truth_turn_deg / places, sum.crease_deg / places, sum.lean_deg / places,
          quartiles(std::move(turns)), mean_along_deg(mesh),        mean_along_deg(truth)};
}

}  // namespace sonoloft
