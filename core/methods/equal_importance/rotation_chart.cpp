#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/methods/equal_importance/charts.h"
#include "core/methods/stack/slice_stack.h"

namespace sonoloft {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kMaxTilt_deg = 1;
/// Of the extent of all slices: how far an axis may be off their planes.
constexpr double kMaxOffset = 0.005;

Vector3d normal_of(const TrackedSlice& slice) {
  return slice.image_to_reference.linear().col(2);
}

Vector3d lifted(const TrackedSlice& slice, const Eigen::Vector2d& p) {
  return slice.image_to_reference * Vector3d(p.x(), p.y(), 0);
}

/// Frame: origin on the axis, z along it, x in the first section.
class RotationChart final : public SliceChart {
 public:
  /// @param angles  [#S] ascending, the first 0, the last pi: that is the first section again, turned over
  explicit RotationChart(std::vector<double> angles) : angles_(std::move(angles)) {}

  [[nodiscard]] std::optional<ChartPlace> locate(const Vector3d& p) const override {
    const double angle = std::atan2(p.y(), p.x()), radius = std::hypot(p.x(), p.y());
    const double turned = angle < 0 ? angle + pi : angle;  // the other half of a section
    const auto above = std::upper_bound(angles_.begin() + 1, angles_.end() - 1, turned);
    const double step = *above - *(above - 1);
    return ChartPlace{static_cast<std::size_t>(above - angles_.begin()) - 1,
                      std::clamp((turned - *(above - 1)) / step, 0.0, 1.0),
                      {angle < 0 ? -radius : radius, p.z()},
                      radius * step,
                      std::numeric_limits<double>::infinity()};
  }

 private:
  std::vector<double> angles_;
};

/// Of the half of a plane that begins at the axis and has the angle: x away from the axis, y along it.
Eigen::Isometry3d plane_at(double angle) {
  Eigen::Isometry3d plane = Eigen::Isometry3d::Identity();
  const Vector3d x(std::cos(angle), std::sin(angle), 0), y = Vector3d::UnitZ();
  plane.linear().col(0) = x;
  plane.linear().col(1) = y;
  plane.linear().col(2) = x.cross(y);
  return plane;
}

/// Whether slices show something on both sides of the axis: most of them, since some may miss what lies there.
bool passes_inside(std::span<const TrackedSlice> slices, const CommonAxis& axis) {
  std::size_t both = 0;
  for (const TrackedSlice& slice : slices) {
    const Vector3d across = normal_of(slice).cross(axis.direction);
    const auto side = [&](const Eigen::Vector2d& p) { return across.dot(lifted(slice, p) - axis.point) > 0; };
    const auto positive = std::ranges::count_if(slice.points, side);
    both += positive > 0 && positive < std::ssize(slice.points);
  }
  return 2 * both > slices.size();
}

}  // namespace

std::optional<CommonAxis> common_axis(std::span<const TrackedSlice> slices) {
  Eigen::AlignedBox3d box;
  Matrix3d spread = Matrix3d::Zero();
  for (const TrackedSlice& s : slices) {
    spread += normal_of(s) * normal_of(s).transpose();
    for (const Eigen::Vector2d& p : s.points) box.extend(lifted(s, p));
  }
  if (box.isEmpty()) return std::nullopt;
  CommonAxis axis;
  axis.direction = Eigen::SelfAdjointEigenSolver<Matrix3d>(spread).eigenvectors().col(0);
  const Matrix3d along = axis.direction * axis.direction.transpose();
  Vector3d offsets = along * box.center();
  for (const TrackedSlice& s : slices) offsets += normal_of(s) * normal_of(s).dot(s.image_to_reference.translation());
  axis.point = (spread + along).ldlt().solve(offsets);
  for (const TrackedSlice& s : slices)
    if (std::abs(normal_of(s).dot(axis.direction)) > std::sin(kMaxTilt_deg * pi / 180) ||
        std::abs(normal_of(s).dot(axis.point - s.image_to_reference.translation())) > kMaxOffset * box.sizes().norm())
      return std::nullopt;
  return passes_inside(slices, axis) ? std::optional(axis) : std::nullopt;
}

Result<ChartedSlices> chart_rotation(std::span<const TrackedSlice> slices, const CommonAxis& axis,
                                     const std::string& method) {
  ChartedSlices charted;
  charted.frame_to_reference.translation() = axis.point;
  charted.frame_to_reference.linear().col(2) = axis.direction;
  charted.frame_to_reference.linear().col(0) = normal_of(slices[0]).cross(axis.direction).normalized();
  charted.frame_to_reference.linear().col(1) =
      axis.direction.cross(charted.frame_to_reference.linear().col(0)).normalized();
  const Eigen::Isometry3d reference_to_frame = charted.frame_to_reference.inverse(Eigen::Isometry);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const Vector3d in_plane = reference_to_frame.linear() * normal_of(slices[i]).cross(axis.direction);
    const double angle = std::atan2(in_plane.y(), in_plane.x());
    order.emplace_back(i == 0 ? 0 : angle < 0 ? angle + pi : angle, i);
  }
  std::ranges::sort(order);
  order.emplace_back(pi, order.front().second);
  std::vector<double> angles;
  for (const auto& [angle, i] : order) {
    auto section = section_in(charted.frame_to_reference * plane_at(angle), slices[i], i + 1, method);
    if (!section) return tl::unexpected<Error>(section.error());
    section->image_to_reference = plane_at(angle);
    if (!angles.empty() && angle - angles.back() < 1e-6)
      return fail(ErrorCode::invalid_argument, method + " takes slices of different angles about their axis; slice " +
                                                   std::to_string(i + 1) +
                                                   " has the angle of another: leave one of them out");
    angles.push_back(angle);
    charted.sections.push_back(std::move(*section));
  }
  summarize(charted);
  charted.steps = differences(angles);
  charted.chart = std::make_unique<RotationChart>(std::move(angles));
  return charted;
}

}  // namespace sonoloft
