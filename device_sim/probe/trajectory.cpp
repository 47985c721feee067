#include "device_sim/probe/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "device_sim/probe/random.h"
#include "device_sim/probe/wander.h"

namespace sonoloft::device_sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double radians(double degrees) {
  return degrees * kPi / 180;
}

/// How the probe stands towards a box. Columns of axes: to the side, into the body, along the sweep.
struct Stand {
  Eigen::Vector3d centre;
  Eigen::Matrix3d axes;
  Eigen::Vector3d half;  ///< of the box, along the axes
  double standoff_mm;

  /// The face over the box's centre, which is `pivot` away from the centre and seen under `turn` about it.
  /// Both in the frame of the axes.
  [[nodiscard]] Eigen::Isometry3d face(const Eigen::Vector3d& pivot, const Eigen::Matrix3d& turn) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const Eigen::Quaterniond rotation(axes * turn);  // by way of a unit quaternion: rigid to the last digit
    pose.linear() = rotation.normalized().toRotationMatrix();
    pose.translation() = centre + axes * pivot - pose.linear().col(1) * (half.y() + standoff_mm);
    return pose;
  }
};

Stand stand_over(const Eigen::AlignedBox3d& box, const SweepOptions& options) {
  const Eigen::Vector3d edges = box.sizes();
  std::array<int, 3> order = {0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return edges[a] < edges[b]; });
  const Eigen::Vector3d depth = Eigen::Vector3d::Unit(order[0]), along = Eigen::Vector3d::Unit(order[2]);
  Stand stand;
  stand.centre = box.center();
  stand.axes << depth.cross(along), depth, along;
  stand.half = stand.axes.transpose().cwiseAbs() * edges / 2;
  stand.standoff_mm = options.standoff_mm.value_or(std::max(stand.half.x(), stand.half.z()));
  return stand;
}

/// The middle of the i-th of n equal parts of [-1, 1].
double part(std::uint32_t i, std::uint32_t n) {
  return (2.0 * i + 1) / n - 1;
}

Eigen::Matrix3d turn(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

/// What a hand cannot hold still.
class Tremor {
 public:
  explicit Tremor(const Hand& hand) : hand_(hand), random_(hand.seed), rotation_(random_), translation_(random_) {}
  void step() {
    rotation_.step(hand_.tremor_correlation, random_);
    translation_.step(hand_.tremor_correlation, random_);
  }
  [[nodiscard]] Eigen::Matrix3d rotation() const {
    const Eigen::Vector3d vector = radians(hand_.tremor_deg) * rotation_.value();
    return turn(vector.norm(), vector.norm() > 0 ? vector.normalized() : Eigen::Vector3d::UnitX());
  }
  [[nodiscard]] Eigen::Vector3d translation_mm() const { return hand_.tremor_mm * translation_.value(); }

 private:
  const Hand& hand_;
  Random random_;
  Wander rotation_, translation_;
};

/// The slices [first, end) of pass number `pass`, where all passes share `slices`.
struct Share {
  std::uint32_t first, end;
  Share(std::uint32_t slices, std::uint32_t pass, std::uint32_t passes)
      : first(static_cast<std::uint32_t>(std::uint64_t{slices} * pass / passes)),
        end(static_cast<std::uint32_t>(std::uint64_t{slices} * (pass + 1) / passes)) {}
};

}  // namespace

Trajectory linear_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options) {
  const Stand stand = stand_over(bounds_mm, options);
  Trajectory trajectory;
  for (std::uint32_t i = 0; i < options.slices; ++i)
    trajectory.push_back(stand.face({0, 0, stand.half.z() * part(i, options.slices)}, Eigen::Matrix3d::Identity()));
  return trajectory;
}

Trajectory fan_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options) {
  const Stand stand = stand_over(bounds_mm, options);
  const Eigen::Isometry3d upright = stand.face(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity());
  const double widest = std::atan2(stand.half.z(), stand.standoff_mm);
  Trajectory trajectory;
  for (std::uint32_t i = 0; i < options.slices; ++i)
    trajectory.push_back(upright * Eigen::AngleAxisd(widest * part(i, options.slices), Eigen::Vector3d::UnitX()));
  return trajectory;
}

Trajectory rotation_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options) {
  const Stand stand = stand_over(bounds_mm, options);
  Trajectory trajectory;
  for (std::uint32_t i = 0; i < options.slices; ++i)
    trajectory.push_back(stand.face(Eigen::Vector3d::Zero(), turn(kPi * i / options.slices, Eigen::Vector3d::UnitY())));
  return trajectory;
}

Trajectory freehand_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options, const Hand& hand) {
  const Stand stand = stand_over(bounds_mm, options);
  Tremor tremor(hand);
  Trajectory trajectory;
  const std::uint32_t passes = std::max(1u, std::min(hand.passes, options.slices));
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    const auto [first, end] = Share(options.slices, pass, passes);
    const double heading = radians(37.0 * (pass / 2) + 90.0 * (pass % 2));
    const Eigen::Matrix3d towards = turn(heading, Eigen::Vector3d::UnitY());
    const Eigen::Vector3d stroke = towards.col(2);
    const double reach = stroke.cwiseAbs().dot(stand.half);
    for (std::uint32_t i = first; i < end; ++i) {
      const double u = part(i - first, end - first), turns = kPi * (u + 1);  // one full turn over the stroke
      const Eigen::Matrix3d rock = turn(radians(hand.tilt_deg) * std::sin(2 * turns), Eigen::Vector3d::UnitX());
      const Eigen::Matrix3d veer = turn(radians(hand.tilt_deg) / 2 * std::sin(turns), Eigen::Vector3d::UnitY());
      trajectory.push_back(
          stand.face(stroke * (reach * u) + tremor.translation_mm(), towards * veer * rock * tremor.rotation()));
      tremor.step();
    }
  }
  return trajectory;
}

Trajectory pass_sweep(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options, double apart_mm,
                      const Hand& hand) {
  constexpr double kShortestStep_mm = 0.5, kLongestStep_mm = 1;
  const struct { double heading_deg, side; } passes[] = {{0, -0.5}, {0, 0.5}, {90, -0.5}, {90, 0.5}, {37, 0}};
  constexpr auto kPasses = static_cast<std::uint32_t>(std::size(passes));
  const Stand stand = stand_over(bounds_mm, options);
  Tremor tremor(hand);
  Trajectory trajectory;
  for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
    const auto [first, end] = Share(options.slices, pass, kPasses);
    const Eigen::Matrix3d towards = turn(radians(passes[pass].heading_deg), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d stroke = towards.col(2), side = towards.col(0) * (passes[pass].side * apart_mm);
    const double extent = 2 * stroke.cwiseAbs().dot(stand.half);
    const double step = std::clamp(extent / std::max(1u, end - first), kShortestStep_mm, kLongestStep_mm);
    for (std::uint32_t i = first; i < end; ++i) {
      const double along = step * (end - first) / 2 * part(i - first, end - first);
      trajectory.push_back(stand.face(stroke * along + side + tremor.translation_mm(), towards * tremor.rotation()));
      tremor.step();
    }
  }
  return trajectory;
}

Trajectory still_probe(const Eigen::AlignedBox3d& bounds_mm, const SweepOptions& options, const Hand& hand) {
  const Stand stand = stand_over(bounds_mm, options);
  Tremor tremor(hand);
  Trajectory trajectory;
  for (std::uint32_t i = 0; i < options.slices; ++i) {
    trajectory.push_back(stand.face(tremor.translation_mm(), tremor.rotation()));
    tremor.step();
  }
  return trajectory;
}

}  // namespace sonoloft::device_sim
